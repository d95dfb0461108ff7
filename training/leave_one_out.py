"""The table by which choices are made: each source judged by what was learned from the others.

Of the real reaches the people of one fold are left out, of the simulated ones a whole generator.
The sets of ``training/held_out.py`` and the other half of the hands at work are never learned from.

Example: python -m training.leave_one_out shared-data --cache parts.pickle
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from igrip.commitment import CommitmentConfig
from igrip.io.resampling import ImportOptions, resample
from igrip.targets.learned.network import Scorer
from training.__main__ import MEMORY, weighted
from training.arms import simulate_arm
from training.handovers import simulate_handovers
from training.hands_at_work import hands_at_work
from training.held_out import NAMES, held_out
from training.learn import fit_scorer
from training.moments import Recording, catalog
from training.people import VALIDATION, real_recordings
from training.sources import SEED, Part, gather, near_far_fold
from training.strangers import Answered, answer, false_commitments, reaches_row
from training.worlds import simulate_person

JUDGED = 60  # people of each generator that judge
REAL = 3  # every third reach of the validation people judges


def near_far(tables: Path) -> list[Recording]:
    """Return reaches of the validation people as the evaluation replays them."""
    recordings = []
    for reach, seed in list(real_recordings(tables, 3, [VALIDATION]))[::REAL]:
        options = ImportOptions(rate=30.0, noise=0.004, seed=seed)
        recording = Recording(
            reach.participant, str(reach.extra["distance"]), resample(reach, catalog(), options),
            reach.hand, reach.target, -1e-9, float(reach.times[-1]), math.inf, 30.0,
        )  # fmt: skip
        recordings.append(recording)
    return recordings


def fit_without(parts: Mapping[str, Part], *left_out: str) -> Scorer:
    """Return a scorer that has learned from all sources but some."""
    kept = {name: part for name, part in parts.items() if name not in left_out}
    return fit_scorer(weighted(kept), MEMORY, SEED)[0]


def judge(recordings: Iterable[Recording], scorer: Scorer) -> list[Answered]:
    """Return what a scorer makes of recordings, without the frames: they fill the memory."""
    return [answer(recording, scorer)._replace(frames=()) for recording in recordings]


def reaches(answered: Sequence[Answered], kind: str = "") -> list[Answered]:
    """Return the reaches of a kind, of any kind by default."""
    return [a for a in answered if _is_reach(a.recording) and a.recording.kind.startswith(kind)]


def _is_reach(recording: Recording) -> bool:
    found = recording.target is not None and not recording.absent
    return found and math.isfinite(recording.end)


def main() -> None:
    """Learn without each source, and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m training.leave_one_out", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("shared", type=Path, help="folder of the sets")
    parser.add_argument("--cache", type=Path, help="file that keeps what was gathered")
    asked = parser.parse_args()
    parts = gather(asked.shared, asked.cache)
    persons = range(10_000, 10_000 + JUDGED)
    sets = {
        near_far_fold(VALIDATION): near_far(asked.shared / "wispinski2021"),
        "worlds": [r for k in persons for r in simulate_person(SEED, k)],
        "arms": [r for k in persons for r in simulate_arm(SEED, k)],
        "handovers": [r for k in persons for r in simulate_handovers(SEED, k)],
    }
    answered = {}
    for name, recordings in sets.items():
        scorer = fit_without(parts, name)
        answered[name] = judge(recordings, scorer)
        print(f"learned without {name}", flush=True)
    everything = fit_without(parts)
    for name in NAMES:
        answered[name] = judge(held_out(asked.shared, name), everything)
    people = answered.pop(near_far_fold(VALIDATION))
    answered |= {kind: reaches(people, kind) for kind in ("near", "far")}
    default = CommitmentConfig()
    print("\n| left out | reaches | 40 % | 60 % | ECE | committed | right | mean part |")
    print(f"|{' --- |' * 8}")
    for name, one in answered.items():
        row = reaches_row(reaches(one), default)
        print(f"| {' | '.join([name, *row])} |", flush=True)
    work = list(hands_at_work(asked.shared / "hands_at_work", SEED, learned=False))
    none_seen = fit_without(parts, "work")
    idle = {
        "hands at work, other sessions": judge(work, everything),
        "hands at work, none learned from": judge(work, none_seen),
    }
    for name in ("worlds", "arms", "handovers"):
        idle[name] = [a for a in answered[name] if a.recording.target is None]
    print("\n| without a reach | false commitments a minute |")
    print(f"|{' --- |' * 2}")
    for name, one in idle.items():
        print(f"| {name} | {false_commitments(one, default):.2f} |", flush=True)


if __name__ == "__main__":
    main()
