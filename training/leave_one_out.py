"""The table by which choices are made: each source judged by what was learned from the others.

Of the real reaches the people of one fold are left out, of the simulated ones a whole generator.

The first run also writes the thresholds of commitments (``--write-risk``), which hold on every
source that was left out. The sets of ``training/held_out.py`` and the other half of the hands at
work are never learned from.

Example: python -m training.leave_one_out ../shared/data --cache parts.pickle
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.commitment import CommitmentConfig, Committer
from igrip.evidence import Evidence
from igrip.io.resampling import ImportOptions, resample
from igrip.lab.evaluation.calibration import ReliabilityBins
from igrip.risk import FILE, default_risk
from igrip.targets import TargetEstimate
from igrip.targets.learned.network import Scorer
from training.__main__ import MEMORY, PERSONS, provenance, weighted
from training.arms import simulate_arm
from training.hands_at_work import hands_at_work
from training.held_out import NAMES, held_out
from training.learn import fit_scorer
from training.moments import Recording, catalog, follow
from training.people import VALIDATION, real_recordings
from training.risk import Commitments, answers, first_commitments, fit_risk, is_reach, write_risk
from training.sources import SEED, Part, gather, near_far_fold
from training.worlds import simulate_person

Array = NDArray[np.float64]
JUDGED = 40  # people of each generator that judge
REAL = 6  # every sixth reach of the validation people judges
Answers = Sequence[tuple[TargetEstimate, Evidence]]


class Judged(NamedTuple):
    """One set of recordings with the answers to them."""

    recordings: list[Recording]
    answers: list[Answers]

    def where(self, holds: Callable[[Recording], bool]) -> Judged:
        """Return those of which something holds."""
        chosen = [k for k, recording in enumerate(self.recordings) if holds(recording)]
        return Judged([self.recordings[k] for k in chosen], [self.answers[k] for k in chosen])


def near_far(tables: Path) -> list[Recording]:
    """Return reaches of the validation people as the evaluation replays them."""
    found = []
    for reach, seed in list(real_recordings(tables, 3, [VALIDATION]))[::REAL]:
        options = ImportOptions(rate=30.0, noise=0.004, seed=seed)
        recording = Recording(
            reach.participant, str(reach.extra["distance"]), resample(reach, catalog(), options),
            reach.hand, reach.target, -1e-9, float(reach.times[-1]), math.inf, 30.0,
        )  # fmt: skip
        found.append(recording)
    return found


def judge(scorer: Scorer, recordings: Sequence[Recording]) -> Judged:
    """Return the answers of a scorer to recordings."""
    return Judged(list(recordings), [answers(scorer, follow(r)) for r in recordings])


def reaches_row(judged: Judged, config: CommitmentConfig) -> dict[str, float]:
    """Return accuracy, calibration and commitments on a set of reaches."""
    right: dict[float, list[bool]] = {0.4: [], 0.6: []}
    stated, hits, parts, correct = [], [], [], []
    for recording, found in zip(judged.recordings, judged.answers, strict=True):
        if not is_reach(recording):
            continue
        length = recording.end - recording.onset
        within = [(e, v) for e, v in found if v.t <= recording.end + 1e-9]
        for part, answered in right.items():
            before = [v for _, v in within if v.t <= recording.onset + part * length + 1e-9]
            answered.append(bool(before) and before[-1].target == recording.target)
        for _, evidence in within:
            if evidence.target is not None:
                stated.append(evidence.confidence[evidence.target])
                hits.append(evidence.target == recording.target)
        committer = Committer(config)
        for _, evidence in within:
            if committer.update(evidence) is not None:
                parts.append(max(0.0, (evidence.t - recording.onset) / length))
                correct.append(committer.target == recording.target)
                break
        else:
            parts.append(math.nan)
    return {
        "reaches": len(parts), "40%": float(np.mean(right[0.4])), "60%": float(np.mean(right[0.6])),
        "ece": ReliabilityBins.of(stated, hits).calibration_error(),
        "committed": float(np.mean(~np.isnan(parts))), "right": float(np.mean(correct)),
        "mean_part": float(np.nan_to_num(parts, nan=1.0).mean()),
    }  # fmt: skip


def false_commitments(judged: Judged, config: CommitmentConfig) -> float:
    """Return how many leases begin in a minute of recordings without a reach."""
    count, minutes = 0, 0.0
    for recording, found in zip(judged.recordings, judged.answers, strict=True):
        committer, newest = Committer(config), None
        for _, evidence in found:
            lease = committer.update(evidence)
            if lease is not None and (lease.target, lease.since) != newest:
                newest = lease.target, lease.since
                count += 1
        minutes += (recording.messages[-1].t - recording.messages[0].t) / 60.0
    return count / minutes


def fit_without(parts: Mapping[str, Part], name: str) -> Scorer:
    """Return a scorer that has learned from all sources but one."""
    return fit_scorer(weighted({k: p for k, p in parts.items() if k != name}), MEMORY, SEED)[0]


def main() -> None:
    """Learn without each source, and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m training.leave_one_out", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("shared", type=Path, help="folder of the sets")
    parser.add_argument("--persons", type=int, default=PERSONS, help="of each generator")
    parser.add_argument("--cache", type=Path, help="file that keeps what was gathered")
    parser.add_argument("--write-risk", action="store_true", help="write the thresholds")
    asked = parser.parse_args()
    tables, work = asked.shared / "wispinski2021", asked.shared / "hands_at_work"
    parts = gather(tables, work, asked.persons, cache=asked.cache)
    persons = range(10_000, 10_000 + JUDGED)
    sets: dict[str, list[Recording]] = {
        near_far_fold(VALIDATION): near_far(tables),
        "worlds": [r for k in persons for r in simulate_person(SEED, k)],
        "arms": [r for k in persons for r in simulate_arm(SEED, k)],
    }
    judged = {}
    for name, recordings in sets.items():
        judged[name] = judge(fit_without(parts, name), recordings)
        print(f"learned without {name}", flush=True)
    commitments = [_first(j) for j in judged.values()]
    risk = fit_risk(commitments)
    if asked.write_risk:
        source = provenance(tables, work, asked.persons) | {"left_out": list(sets)}
        write_risk(risk, source, FILE)
        default_risk.cache_clear()
    print({name: column.tolist() for name, column in risk._asdict().items()})
    everything, never_work = fit_without(parts, ""), fit_without(parts, "work")
    for name in NAMES:
        judged[name] = judge(everything, list(held_out(asked.shared, name)))
    people = judged.pop(near_far_fold(VALIDATION))
    judged["near"] = people.where(lambda r: r.kind == "near")
    judged["far"] = people.where(lambda r: r.kind == "far")
    config = CommitmentConfig()
    print("| left out | reaches | 40 % | 60 % | ECE | committed | right | mean part |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, one in judged.items():
        row: dict[str, Any] = reaches_row(one, config)
        shares = [f"{100 * row[key]:.1f} %" for key in ("40%", "60%")]
        rest = [f"{100 * row[key]:.1f} %" for key in ("committed", "right", "mean_part")]
        cells = [name, str(row["reaches"]), *shares, f"{row['ece']:.3f}", *rest]
        print(f"| {' | '.join(cells)} |", flush=True)
    resting = list(hands_at_work(work, SEED, learned=False))
    for label, scorer in (("other sessions", everything), ("all sessions", never_work)):
        rate = false_commitments(judge(scorer, resting), config)
        print(
            f"false commitments a minute, hands at work, {label} left out: {rate:.2f}", flush=True
        )
    for name in ("worlds", "arms"):
        idle = judged[name].where(lambda r: r.target is None)
        print(f"false commitments a minute, {name}: {false_commitments(idle, config):.2f}")


def _first(judged: Judged) -> Commitments:
    return first_commitments(
        (r, [v for _, v in found])
        for r, found in zip(judged.recordings, judged.answers, strict=True)
        if is_reach(r)
    )


if __name__ == "__main__":
    main()
