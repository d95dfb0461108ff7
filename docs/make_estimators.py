"""Make the tables of all estimators on all sets: ``make estimators REACHES=folder``.

The folder holds the tables of the near/far reaches. Everything else is simulated. Takes about half
an hour on two cores; writes docs/estimators-tables.md.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from igrip.lab.evaluation.calibration import BINS, ReliabilityBins, interval_over_groups

HERE = Path(__file__).parent
OUT = HERE / "estimators-tables.md"
ORDER = (
    "bayes", "repaired", "paper", "impacts", "distance_derivative", "distance", "future_distance",
    "nearest", "heading", "gaussians", "mixtures", "templates",
)  # fmt: skip
EARLY = ("30%", "40%", "50%", "60%")
NO_REACH = "none"


def igrip(*arguments: object) -> None:
    """Run the command."""
    print("igrip", *arguments, file=sys.stderr)
    subprocess.run([sys.executable, "-m", "igrip", *map(str, arguments)], check=True)


def evaluate(dataset: Path, out: Path, *options: object) -> tuple[dict[str, Any], pd.DataFrame]:
    """Return summary and trials of a dataset, evaluated with every estimator."""
    igrip("evaluate", dataset, "--out", out, *options)
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    return summary, pd.read_parquet(out / "trials.parquet")


def import_reaches(reaches: Path, data: Path, people: Path, *options: object) -> Path:
    """Import the reaches of some people, with the noise of a camera; return the dataset."""
    igrip(
        "import", reaches, "--out", data, "--noise", 0.004, "--participants", people, *options
    )  # fmt: skip
    return data


def options_for(names: Sequence[str]) -> list[str]:
    """Return the options that choose some estimators."""
    return [part for name in names for part in ("--targets", name)]


def make(reaches: Path, work: Path, quick: bool) -> Iterator[str]:
    """Yield the page, line by line."""
    kept = work / "kept-back.txt"
    with kept.open("w", encoding="utf-8") as file:
        subprocess.run(
            [sys.executable, "-m", "training.people", str(reaches)], check=True, stdout=file
        )
    few = ["--limit", 200] if quick else []
    ece: dict[str, tuple[float, int]] = {}
    yield "# Every estimator on every set"
    yield ""
    if quick:
        yield "Made by `python docs/make_estimators.py REACHES --quick`: 200 reaches of each real set and small cohorts, so the intervals are wide."
    else:
        yield "Made by `make estimators REACHES=…`."
    yield "95 % intervals over participants in brackets."
    for title, rest in (("as recorded", 0), ("after 1 s of rest", 1)):
        data = import_reaches(reaches, work / f"near-far-{rest}", kept, "--rest", rest, *few)
        summary, trials = evaluate(data, work / f"near-far-{rest}-report", *options_for(ORDER))
        yield from near_far(f"Near/far reaches, people kept back, {title}", summary, trials)
        ece[f"near/far, {title}"] = calibration(summary)
    for rate in (15, 60, 120):
        data = import_reaches(reaches, work / f"near-far-{rate}-hz", kept, "--rate", rate, *few)
        names = options_for(("bayes", "paper"))
        summary, trials = evaluate(data, work / f"near-far-{rate}-hz-report", *names)
        yield from near_far(f"The same at {rate} Hz, as recorded", summary, trials)
    for profile, people in (("healthy", 11), ("stroke", 5), ("sci", 5)):
        data = work / profile
        size = ["--trials", 4, "--no-reach", 4] if quick else []
        igrip("simulate", data, "--profile", profile, "--participants", people, *size)
        names = options_for(ORDER if profile == "healthy" else ("bayes", "paper", "repaired"))
        summary, trials = evaluate(data, work / f"{profile}-report", *names)
        yield from cohort(f"Simulated cohort, {profile}", summary, trials)
        ece[f"cohort, {profile}"] = calibration(summary)
        if profile == "healthy":
            names = [*options_for(["bayes"]), "--grips", "cylinder"]
            _, paper = evaluate(data, work / "cylinder-report", *names)
            yield from grips(trials[trials["targets"] == "bayes"], paper)
    yield "\n## Calibration of `bayes`\n"
    yield "| set | ECE | predictions |\n| --- | --- | --- |"
    for name, (error, answers) in ece.items():
        yield f"| {name} | {error:.3f} | {answers} |"
    yield f"| pooled | {pooled(work):.3f} | {sum(n for _, n in ece.values())} |"


def calibration(summary: dict[str, Any]) -> tuple[float, int]:
    """Return the calibration error of bayes, and over how many predictions."""
    result = summary["targets"]["bayes"]["calibration"]
    return result["ece"], result["answers"]


def pooled(work: Path) -> float:
    """Return the calibration error over the predictions of all sets together."""
    sums = np.zeros((3, BINS))
    for name in ("near-far-0", "near-far-1", "healthy", "stroke", "sci"):
        path = work / f"{name}-report" / "summary.json"
        summary = json.loads(path.read_text(encoding="utf-8"))
        for bin in summary["targets"]["bayes"]["calibration"]["bins"]:
            k = min(int(bin["stated"] * BINS), BINS - 1)
            sums[:, k] += np.array([1.0, bin["stated"], bin["right"]]) * bin["answers"]
    return ReliabilityBins(*sums).calibration_error()


def percent(values: pd.Series, rows: pd.DataFrame) -> str:
    """Return a mean with its interval over participants."""
    low, high = interval_over_groups(values, rows["participant"])
    return f"{100 * values.mean():.1f} [{100 * low:.0f}–{100 * high:.0f}]"


def early(rows: pd.DataFrame) -> pd.Series:
    """Return the mean accuracy at 30, 40, 50 and 60 % of each trial."""
    return rows[[f"right_at_{part}" for part in EARLY]].astype(float).mean(axis=1)


def named(trials: pd.DataFrame, names: Sequence[str]) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the reaches as scored for each estimator."""
    for name in names:
        rows = trials[(trials["targets"] == name) & (trials["target"] != NO_REACH)]
        yield name, rows.sort_values("recording").reset_index(drop=True)


def near_far(title: str, summary: dict[str, Any], trials: pd.DataFrame) -> Iterator[str]:
    """Yield the table of a set of near and far reaches."""
    yield f"\n## {title}\n"
    yield f"{summary['reaches']} reaches of {trials['participant'].nunique()} people.\n"
    yield "| targets | trials: near | far | at 40 %: near | far | mean | at 60 %: near | far | mean | 30–60 % less `paper` |"
    yield "| --- |" + " --- |" * 9
    names = [n for n in ORDER if n in set(trials["targets"])]
    every = dict(named(trials, names))
    for name, rows in every.items():
        cells = []
        for column in ("success", "right_at_40%", "right_at_60%"):
            values = rows[column].astype(float)
            parts = [values[rows["group"] == g].mean() for g in ("near", "far")]
            cells += [
                percent(values[rows["group"] == g], rows[rows["group"] == g])
                for g in ("near", "far")
            ]
            cells += [] if column == "success" else [f"{50 * sum(parts):.1f}"]
        yield f"| `{name}` | {' | '.join(cells)} | {percent(early(rows) - early(every['paper']), rows)} |"


def cohort(title: str, summary: dict[str, Any], trials: pd.DataFrame) -> Iterator[str]:
    """Yield the table of a simulated cohort."""
    yield f"\n## {title}\n"
    yield f"{summary['valid']} of {summary['reaches']} reaches valid.\n"
    yield "| targets | trials, valid | seen in time | at 40 % | 60 % | at the end | 30–60 %, valid | all | less `paper`, valid | less `paper`, all | none likeliest, no reach |"
    yield "| --- |" + " --- |" * 10
    names = [n for n in ORDER if n in set(trials["targets"])]
    every = dict(named(trials, names))
    for name, rows in every.items():
        valid = rows["valid"] == True  # noqa: E712 - the column may hold None
        seen = rows[rows["both_seen_0.3s_before_end"] == True]  # noqa: E712
        good, less = rows[valid], early(rows) - early(every["paper"])
        none = summary["targets"][name]["no_reach"].get("none_most_probable")
        cells = [
            percent(good["success"].astype(float), good),
            percent(seen["success"].astype(float), seen),
        ]
        cells += [
            percent(good[f"right_at_{part}"].astype(float), good) for part in ("40%", "60%", "100%")
        ]
        cells += [f"{100 * early(good).mean():.1f}", f"{100 * early(rows).mean():.1f}"]
        cells += [percent(less[valid], good), percent(less, rows)]
        yield f"| `{name}` | {' | '.join(cells)} | {'–' if none is None else f'{100 * none:.1f} %'} |"


def grips(contact: pd.DataFrame, paper: pd.DataFrame) -> Iterator[str]:
    """Yield the grip by where the hand will touch, beside the paper's rule, same targets."""
    yield "\n## Grip, targets by `bayes`, valid trials\n"
    yield "| grips | trials | at 40 % | 60 % | 85 % | at the end |\n| --- | --- | --- | --- | --- | --- |"
    both = {}
    for name, rows in (("contact", contact), ("cylinder", paper)):
        good = rows[rows["valid"] == True].sort_values("recording").reset_index(drop=True)  # noqa: E712
        both[name] = good
        cells = [
            percent(good[f"grip_{c}"].astype(float), good)
            for c in ("success", "right_at_40%", "right_at_60%", "right_at_85%", "right_at_100%")
        ]
        yield f"| `{name}` | {' | '.join(cells)} |"
    found = [both[n]["grip_found_s"].astype(float) for n in ("cylinder", "contact")]
    gain = (found[0] - found[1]).dropna()
    rows = both["contact"].loc[gain.index]
    low, high = interval_over_groups(gain, rows["participant"])
    yield f"\n`contact` has its final grip {gain.mean():.3f} s [{low:.3f} to {high:.3f}] earlier than `cylinder`, mean over the trials in which both have it."


def main() -> None:
    """Write the page."""
    reaches = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        lines = list(make(reaches, Path(folder), "--quick" in sys.argv))
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
