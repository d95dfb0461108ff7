"""Real reaches for training, and the people who are kept back to judge by."""

from __future__ import annotations

import math
import sys
import zlib
from collections.abc import Container, Iterator
from pathlib import Path

import numpy as np

from igrip.io.importers import ImportFiles, RecordedReach
from igrip.io.importers.wispinski2021 import Wispinski2021
from igrip.io.resampling import ImportOptions, resample
from training.moments import THINGS, Recording, catalog

FOLDS, KEPT_BACK, VALIDATION = 5, 1, 0
LEARNED_FROM = tuple(k for k in range(FOLDS) if k != KEPT_BACK)
EACH = 160  # reaches of each person
NOISES = (0.0, 0.0005, 0.001, 0.002, 0.004, 0.004, 0.006)  # of the sensor, each axis [m]


def fold(participant: str) -> int:
    """Return the fold of a person: always the same, whoever else there is."""
    return zlib.crc32(participant.encode()) % FOLDS


def real_reaches(tables: Path) -> list[RecordedReach]:
    """Return all reaches of the near/far data."""
    return [read() for read in Wispinski2021().reaches(ImportFiles([tables]))]


def real_recordings(
    tables: Path, seed: int, folds: Container[int]
) -> Iterator[tuple[RecordedReach, int]]:
    """Return reaches of the people of some folds, a few of each, and a seed for each."""
    by_person: dict[str, list[RecordedReach]] = {}
    for reach in real_reaches(tables):
        by_person.setdefault(reach.participant, []).append(reach)
    for person, reaches in sorted(by_person.items()):
        if fold(person) not in folds:
            continue
        random = np.random.default_rng([seed, zlib.crc32(person.encode())])
        for k in random.permutation(len(reaches))[:EACH]:
            yield reaches[k], int(random.integers(2**31))


def record(reach: RecordedReach, seed: int) -> Recording:
    """Return one reach as a sensor of some rate and noise would record it, with some object's mesh.

    In one of eight the target is never detected: the reach is then for none of the objects.
    """
    random = np.random.default_rng(seed)
    rate = float(random.choice([15.0, 20.0, 30.0, 30.0, 30.0, 60.0, 120.0]))
    rest = round(float(random.choice([0.0, 0.0, 0.5, 1.0, 1.5])) * rate) / rate
    options = ImportOptions(
        mesh=THINGS[int(random.integers(len(THINGS)))], rate=rate, rest=rest,
        noise=float(random.choice(NOISES)), seed=seed,
    )  # fmt: skip
    recording = Recording(
        person=reach.participant, kind="near" if reach.extra["distance"] == "near" else "far",
        messages=resample(reach, catalog(), options), hand=reach.hand, target=reach.target,
        onset=rest - 1e-9, end=rest + float(reach.times[-1]), back=math.inf, rate=rate,
    )  # fmt: skip
    absent = random.random() < 0.125
    return recording.with_absent_target() if absent else recording


def main() -> None:
    """Print the people who are kept back: ``python -m training.people TABLES > kept-back.txt``."""
    people = {reach.participant for reach in real_reaches(Path(sys.argv[1]))}
    print(*sorted(person for person in people if fold(person) == KEPT_BACK), sep="\n")


if __name__ == "__main__":
    main()
