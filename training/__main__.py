"""Train what ships: the scorer of ``bayes``, the library of the field's methods, the grip.

Example: python -m training ../shared/data/wispinski2021 --check
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.grips.contact import WEIGHTS as CONTACT
from igrip.io.importers import RecordedReach
from igrip.targets.bayes import WEIGHTS
from igrip.targets.learned.network import read_scorer
from igrip.targets.learned.reach_library import LIBRARY
from training.grip import approaches_of, fit_grip, write_grip
from training.learn import fit_scorer, inputs_of, probabilities, write_scorer
from training.library import Demonstration, demonstrated, fit_library, write_library
from training.moments import Moments, Recording, follow, joined, moments_of, thinned
from training.people import EACH, FOLDS, LEARNED_FROM, real_recordings, record
from training.worlds import TRIALS, simulate_person

SEED = 20260
PERSONS = 720
MEMORY = 0.02  # s; docs/estimators.md has the alternatives
REAL = 2.0  # weight of all real moments, that of all simulated ones being 1
EVERY = 3  # every third reach is a demonstration for the field's methods

Array = NDArray[np.float64]


class Part(NamedTuple):
    """What is learned from some recordings: for the scorer, the field's methods, the grip."""

    moments: Moments
    demonstrations: list[Demonstration]
    approaches: list[Array]


def part_of(recordings: Sequence[Recording]) -> Part:
    """Return what is learned from a few recordings."""
    moments, demonstrations, approaches = [], [], []
    for k, recording in enumerate(recordings):
        frames = follow(recording)
        moments.append(moments_of(recording, frames))
        if recording.kind in ("near", "far", "reach") and not recording.absent:
            if k % EVERY == 0 and (one := demonstrated(recording, frames)) is not None:
                demonstrations.append(one)
            if recording.grip is not None:
                approaches.append(approaches_of(recording, frames))
    return Part(joined(moments), demonstrations, approaches)


def real_part(jobs: Sequence[tuple[RecordedReach, int]]) -> Part:
    """Return what is learned from some real reaches."""
    return part_of([record(*job) for job in jobs])


def simulated_part(number: int) -> Part:
    """Return what is learned from one simulated person."""
    return part_of(simulate_person(SEED, number))


def gather(tables: Path, persons: int, folds: Sequence[int] = LEARNED_FROM) -> Part:
    """Return everything to learn from."""
    jobs = list(real_recordings(tables, SEED, folds))
    groups = [jobs[k : k + EACH] for k in range(0, len(jobs), EACH)]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        real = _collected(pool.map(real_part, groups), len(groups), "groups of real reaches")
        simulated = _collected(
            pool.map(simulated_part, range(persons)), persons, "simulated people"
        )
    moments = [thinned(joined([p.moments for p in parts]), SEED) for parts in (real, simulated)]
    moments[0].weight[:] *= REAL * moments[1].weight.sum() / moments[0].weight.sum()
    every = [*real, *simulated]
    return Part(
        joined(moments), [x for part in every for x in part.demonstrations],
        [x for part in every for x in part.approaches],
    )  # fmt: skip


def _collected(parts: Any, count: int, what: str) -> list[Part]:
    """Collect parts and print the progress."""
    done = []
    for part in parts:
        done.append(part)
        print(f"\r{len(done)} of {count} {what}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return done


def provenance(tables: Path, persons: int) -> dict[str, Any]:
    """Return what is learned from."""
    files = sorted(tables.glob("*.parquet"))
    return {
        "made_by": "python -m training (docs/estimators.md)",
        "real": f"Wispinski et al. 2021, near/far; {FOLDS - 1} of {FOLDS} folds of people, "
        f"at most {EACH} reaches of each",
        "tables": {f.name: hashlib.sha256(f.read_bytes()).hexdigest()[:16] for f in files},
        "simulated": f"{persons} people of training/worlds.py, {TRIALS} trials each",
        "seed": SEED,
    }


def main() -> int:
    """Train, and write or compare."""
    parser = argparse.ArgumentParser(
        prog="python -m training", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("reaches", type=Path, help="folder with trials.parquet and reaches.parquet")
    parser.add_argument("--persons", type=int, default=PERSONS, help="simulated people")
    parser.add_argument(
        "--check", action="store_true", help="compare with what ships, write nothing"
    )
    asked = parser.parse_args()
    began = time.monotonic()
    moments, demonstrations, approaches = gather(asked.reaches, asked.persons)
    scorer, loss = fit_scorer(moments, MEMORY, SEED)
    learned, grip = fit_library(demonstrations, SEED), fit_grip(approaches)
    passed = time.monotonic() - began
    print(
        f"{len(moments.target)} moments, loss {loss:.4f}; {len(demonstrations)} reaches; "
        f"{passed:.0f} s",
        file=sys.stderr,
    )
    if asked.check:
        shipped = read_scorer(WEIGHTS)
        inputs, frame = inputs_of(moments), moments.frame
        ours, theirs = (probabilities(s, inputs, frame) for s in (scorer, shipped))
        off = float(np.abs(ours - theirs).max())
        print(f"scorer: largest difference of a probability {off:.3g}")
        there = json.loads(LIBRARY.read_text(encoding="utf-8"))
        grips = json.loads(CONTACT.read_text(encoding="utf-8"))["weights"]
        apart = max(_apart(learned, {key: there[key] for key in learned}), _apart(grip, grips))
        print(f"library and grip: largest difference of a number {apart:.3g}")
        return int(not (off <= 1e-6 and apart <= 1e-6))
    source = provenance(asked.reaches, asked.persons)
    write_scorer(replace(scorer, provenance=source | {"loss": round(loss, 4)}), WEIGHTS)
    write_library({**learned, "provenance": source}, LIBRARY)
    write_grip(grip, source, CONTACT)
    return 0


def _apart(a: Any, b: Any) -> float:
    """Return the largest difference between two nests of numbers."""
    if isinstance(a, dict):
        return max(_apart(a[key], b[key]) for key in a)
    if isinstance(a, str):
        return 0.0 if a == b else float("inf")
    return float(np.abs(np.array(a) - np.array(b)).max())


if __name__ == "__main__":
    sys.exit(main())
