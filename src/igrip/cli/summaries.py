"""What ``igrip replay`` says at the end: as plain data, and as tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.replay import FRACTIONS, TrialResult

GROUPS = "distance"  # the column by which a table is split, where a dataset has it


def recording_summary(
    path: str, targets: str, messages: int, seconds: float, intentions: Sequence[Intention]
) -> dict[str, Any]:
    """Sum up one recording: for each hand, its reaches and what they were taken for."""
    hands = sorted({intention.hand for intention in intentions})
    return {
        "recording": path,
        "targets": targets,
        "messages": messages,
        "seconds": seconds,
        "intentions": len(intentions),
        "hands": {hand: _hand([i for i in intentions if i.hand == hand]) for hand in hands},
    }


def _hand(intentions: Sequence[Intention]) -> dict[str, Any]:
    reaches: list[list[Intention]] = []
    before = None
    for intention in intentions:
        if intention.status == "reaching":
            if before != "reaching":
                reaches.append([])
            reaches[-1].append(intention)
        before = intention.status
    return {
        "statuses": dict(Counter(intention.status for intention in intentions)),
        "reaches": [_reach(reach) for reach in reaches],
    }


def _reach(intentions: Sequence[Intention]) -> dict[str, Any]:
    last = intentions[-1]
    since = last.t
    for intention in reversed(intentions):
        if intention.target != last.target:
            break
        since = intention.t
    return {
        "begin": intentions[0].t,
        "end": last.t,
        "target": last.target,
        "grip": last.grip,
        "confidence": last.confidence,
        "same_target_since": since,
    }


def print_recording(console: Console, summary: dict[str, Any]) -> None:
    """Print what :func:`recording_summary` returned."""
    console.print(
        f"{summary['recording']}: {summary['messages']} messages, {summary['seconds']:.1f} s, "
        f"{summary['intentions']} intentions by {summary['targets']}",
    )
    table = Table("hand", "reach", "target", "settled after", "grip", "score")
    for hand, found in summary["hands"].items():
        for reach in found["reaches"]:
            score = reach["confidence"]
            table.add_row(
                hand,
                f"{reach['begin']:.2f}-{reach['end']:.2f} s",
                reach["target"] or "-",
                f"{reach['same_target_since'] - reach['begin']:.2f} s",
                reach["grip"] or "-",
                "-" if score is None else f"{score:.2f}",
            )
    console.print(table if table.row_count else "no hand reached")


def dataset_summary(dataset: Dataset, results: Sequence[TrialResult]) -> dict[str, Any]:
    """Sum up a dataset: success and accuracy for each estimator, all trials and each group."""
    names = list(dict.fromkeys(result.targets for result in results))
    groups = sorted({r.trial.extra[GROUPS] for r in results if GROUPS in r.trial.extra})
    table = []
    for name in names:
        own = [result for result in results if result.targets == name]
        table.append({"targets": name, "group": "all", **_scores(own)})
        for group in groups:
            part = [result for result in own if result.trial.extra.get(GROUPS) == group]
            table.append({"targets": name, "group": group, **_scores(part)})
    problems = [
        {"recording": r.trial.recording, "trial": r.trial.trial, "targets": r.targets,
         "problem": r.problem}
        for r in results if r.problem is not None
    ]  # fmt: skip
    people = {result.trial.participant for result in results} - {None}
    return {
        "dataset": dataset.name,
        "derived": dataset.description.get("derived"),
        "trials": len({result.trial.recording for result in results}),
        "participants": len(people),
        "results": table,
        "problems": problems,
        "cut": sorted({result.cut for result in results if result.cut}),
    }


def _scores(results: Sequence[TrialResult]) -> dict[str, Any]:
    scored = [(r.score, r.accurate) for r in results if r.score is not None]
    if not scored:
        return {"trials": 0}
    delays = [score.delay for score, _ in scored if score.success and score.delay is not None]
    margins = [score.margin for score, _ in scored if score.success and score.margin is not None]
    accurate = np.mean([accurate for _, accurate in scored], axis=0)
    return {
        "trials": len(scored),
        "success": float(np.mean([score.success for score, _ in scored])),
        **{f"accuracy_{f:.0%}": float(a) for f, a in zip(FRACTIONS, accurate, strict=True)},
        "delay_s": float(np.mean(delays)) if delays else None,
        "delay_clipped_s": float(np.mean(np.maximum(delays, 0.0))) if delays else None,
        "margin_s": float(np.mean(margins)) if margins else None,
    }


def print_dataset(console: Console, summary: dict[str, Any]) -> None:
    """Print what :func:`dataset_summary` returned."""
    console.print(
        f"{summary['dataset']}: {summary['trials']} trials of {summary['participants']} "
        f"participants; {summary['times_real_time']:.0f} × real time on "
        f"{summary['processes']} process(es)",
    )
    for key, value in (summary["derived"] or {}).items():
        console.print(f"  {key}: {value}")
    table = Table()
    table.add_column("targets", overflow="fold", min_width=len("distance_derivative"))
    table.add_column("group")
    for column in ("trials", "success", *(f"right at {f:.0%}" for f in FRACTIONS)):
        table.add_column(column, justify="right")
    for column in ("delay", "from onset on", "margin"):
        table.add_column(column, justify="right")
    for row in summary["results"]:
        if not row["trials"]:
            table.add_row(row["targets"], row["group"], "0")
            continue
        shares = [row["success"], *(row[f"accuracy_{f:.0%}"] for f in FRACTIONS)]
        times = [row["delay_s"], row["delay_clipped_s"], row["margin_s"]]
        table.add_row(
            row["targets"],
            row["group"],
            str(row["trials"]),
            *(f"{100 * share:.1f} %" for share in shares),
            *("-" if seconds is None else f"{seconds:.2f} s" for seconds in times),
        )
    console.print(table)
    for cut in summary["cut"]:
        console.print(cut, style="yellow", soft_wrap=True)
    problems = summary["problems"]
    if problems:
        console.print(f"{len(problems)} result(s) are missing:", style="yellow")
        for found in problems[:10]:
            words = f"  {found['recording']} ({found['targets']}): {found['problem']}"
            console.print(words, soft_wrap=True)
