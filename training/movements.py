"""Train what is learned of movements alone: their familiarity, the times of contact and of the end.

Example: python -m training.movements ../shared/data/wispinski2021 --check
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.io.importers import RecordedReach
from igrip.targets.learned.familiarity import FILE as FAMILIARITY
from igrip.targets.learned.familiarity import read_movements
from igrip.targets.learned.timing import FILE as TIMING
from igrip.targets.learned.timing import read_timing
from training.__main__ import SEED, provenance
from training.arms import simulate_arm
from training.familiarity import fit_familiarity, write_familiarity
from training.moments import Moments, Recording, follow, joined, moments_of, thinned
from training.people import EACH, LEARNED_FROM, real_recordings, record
from training.timing import TimingSamples, fit_timing, join_timing, timing_samples, write_timing
from training.worlds import simulate_person

PERSONS = 80  # of each generator


class Part(NamedTuple):
    """What is learned from some recordings."""

    moments: Moments
    timing: TimingSamples


def part_of(recordings: Iterable[Recording]) -> Part:
    """Return what is learned from a few recordings: those of reaches for what is seen."""
    moments, timing = [], []
    for recording in recordings:
        if recording.target is None or recording.absent:
            continue  # each person has reaches left
        frames = follow(recording)
        moments.append(moments_of(recording, frames))
        timing.append(timing_samples(recording, frames))
    return Part(joined(moments), join_timing(timing))


def join(parts: Sequence[Part]) -> Part:
    """Return several parts as one."""
    return Part(joined([p.moments for p in parts]), join_timing([p.timing for p in parts]))


def _real(jobs: Sequence[tuple[RecordedReach, int]]) -> Part:
    return part_of(record(*job) for job in jobs)


def _world(number: int) -> Part:
    return part_of(simulate_person(SEED, number))


def _arm(number: int) -> Part:
    return part_of(simulate_arm(SEED, number))


def gather(tables: Path, persons: int) -> dict[str, Part]:
    """Return what is learned from each source, by name."""
    jobs = list(real_recordings(tables, SEED, LEARNED_FROM))
    groups = [jobs[k : k + EACH] for k in range(0, len(jobs), EACH)]
    parts = {}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for name, function, items in (
            ("near_far", _real, groups), ("worlds", _world, range(persons)),
            ("arms", _arm, range(persons)),
        ):  # fmt: skip
            parts[name] = join(_collected(pool.map, function, items, name))
    return parts


def _collected(
    run: Callable[..., Iterable[Part]], function: Callable[[Any], Part], items: Sequence[Any],
    name: str,
) -> list[Part]:  # fmt: skip
    """Collect parts and print the progress."""
    done = []
    for part in run(function, items):
        if len(part.moments.target):
            done.append(part)
        print(f"\r{name}: {len(done)} of {len(items)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return done


def main() -> int:
    """Train, and write or compare."""
    parser = argparse.ArgumentParser(
        prog="python -m training.movements", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("reaches", type=Path, help="folder with trials.parquet and reaches.parquet")
    parser.add_argument("--persons", type=int, default=PERSONS, help="of each generator")
    parser.add_argument(
        "--check", action="store_true", help="compare with what ships, write nothing"
    )
    asked = parser.parse_args()
    began = time.monotonic()
    parts = gather(asked.reaches, asked.persons)
    familiar = fit_familiarity(thinned(parts["near_far"].moments, SEED))
    timing = fit_timing([part.timing for part in parts.values()], SEED)
    print(f"{time.monotonic() - began:.0f} s", file=sys.stderr)
    if asked.check:
        pairs = [*zip(familiar, read_movements(FAMILIARITY), strict=True)]
        pairs += zip(timing, read_timing(TIMING), strict=True)
        apart = max(float(np.abs(ours - shipped).max()) for ours, shipped in pairs)
        print(f"familiarity and timing: largest difference of a number {apart:.3g}")
        return int(not apart <= 1e-6)
    source = provenance(asked.reaches, asked.persons) | {
        "made_by": "python -m training.movements (docs/estimators.md)",
        "simulated": f"{asked.persons} people each of training/worlds.py and training/arms.py",
    }
    write_familiarity(familiar, source, FAMILIARITY)
    write_timing(timing, source, TIMING)
    return 0


if __name__ == "__main__":
    sys.exit(main())
