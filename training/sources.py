"""What the estimators learn from, source by source: recordings, seen as the estimator sees them."""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.io.importers import RecordedReach
from training.arms import simulate_arm
from training.grip import approaches_of
from training.hands_at_work import hands_at_work
from training.library import Demonstration, demonstrated
from training.moments import Moments, Recording, follow, joined, moments_of
from training.people import EACH, LEARNED_FROM, real_recordings, record
from training.timing import TimingSamples, timing_samples
from training.worlds import simulate_person

Array = NDArray[np.float64]
SEED = 20260
WEIGHTS = {"near_far": 2.0, "worlds": 1.0, "arms": 1.0, "work": 0.2}
"""Weight of all moments of each source; real reaches count twice."""
EVERY = 3  # every third reach is a demonstration for the field's methods


class Part(NamedTuple):
    """What is learned from some recordings, by learner.

    Attributes
    ----------
    moments : Moments
        For the scorer and the familiarity.
    timing : TimingSamples
        For the times of contact and of the end.
    demonstrations : list of Demonstration
        For the field's methods.
    approaches : list of arrays
        For the grip.
    """

    moments: Moments
    timing: TimingSamples
    demonstrations: list[Demonstration]
    approaches: list[Array]


def part_of(recordings: Iterable[Recording]) -> Part:
    """Return what is learned from a few recordings."""
    moments, timing, demonstrations, approaches = [], [], [], []
    for k, recording in enumerate(recordings):
        frames = follow(recording)
        moments.append(moments_of(recording, frames))
        if recording.target is None or recording.absent:
            continue
        timing.append(timing_samples(recording, frames))
        if k % EVERY == 0 and (one := demonstrated(recording, frames)) is not None:
            demonstrations.append(one)
        if recording.grip is not None:
            approaches.append(approaches_of(recording, frames))
    return Part(joined(moments), joined_timing(timing), demonstrations, approaches)


def joined_timing(samples: Sequence[TimingSamples]) -> TimingSamples:
    """Return samples of several recordings as one."""
    if not samples:
        return timing_samples_of_none()
    return TimingSamples(*(np.concatenate(column) for column in zip(*samples, strict=True)))


def timing_samples_of_none() -> TimingSamples:
    """Return no samples."""
    from igrip.targets.learned.timing import INPUTS

    return TimingSamples(np.empty((0, len(INPUTS))), np.empty((0, 2)), np.empty(0))


def joined_parts(parts: Sequence[Part]) -> Part:
    """Return what is learned from several parts as one."""
    return Part(
        joined([p.moments for p in parts]), joined_timing([p.timing for p in parts]),
        [x for p in parts for x in p.demonstrations], [x for p in parts for x in p.approaches],
    )  # fmt: skip


def near_far_fold(fold: int) -> str:
    """Return the name of one fold of the near/far people: a source of its own."""
    return f"near_far {fold}"


def source_weight(name: str, names: Sequence[str]) -> float:
    """Return the weight of a source among others; the folds of the near/far people share theirs."""
    kind = name.split(" ")[0]
    return WEIGHTS[kind] / sum(other.split(" ")[0] == kind for other in names)


def _real(jobs: Sequence[tuple[RecordedReach, int]]) -> Part:
    return part_of(record(*job) for job in jobs)


def _world(number: int) -> Part:
    part = part_of(simulate_person(SEED, number))
    return part


def _arm(number: int) -> Part:
    part = part_of(simulate_arm(SEED, number))
    return part._replace(demonstrations=[])  # the field's methods learn from the other sources


def _work(recordings: Sequence[Recording]) -> Part:
    return part_of(recordings)


def gather(
    tables: Path, work: Path, persons: int, folds: Sequence[int] = LEARNED_FROM,
    cache: Path | None = None,
) -> dict[str, Part]:  # fmt: skip
    """Return what is learned from each source, by name.

    Parameters
    ----------
    tables, work : Path
        Folders of the near/far reaches and of the hands at work.
    persons : int
        Simulated people of each generator.
    folds : sequence of int
        Folds of the people of the near/far reaches.
    cache : Path, optional
        A file that keeps the result for the next call.
    """
    if cache is not None and cache.exists():
        found: dict[str, Part] = pickle.loads(cache.read_bytes())
        return found
    hands = list(hands_at_work(work, SEED, learned=True))
    stretches = [hands[k : k + 10] for k in range(0, len(hands), 10)]
    parts: dict[str, Part] = {}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for fold in folds:
            jobs = list(real_recordings(tables, SEED, [fold]))
            groups = [jobs[k : k + EACH] for k in range(0, len(jobs), EACH)]
            name = near_far_fold(fold)
            parts[name] = joined_parts(_collected(pool.map, _real, groups, name))
        for name, function, items in (
            ("worlds", _world, range(persons)),
            ("arms", _arm, range(persons)), ("work", _work, stretches),
        ):  # fmt: skip
            parts[name] = joined_parts(_collected(pool.map, function, items, name))
    if cache is not None:
        cache.write_bytes(pickle.dumps(parts))
    return parts


def _collected(
    run: Callable[..., Iterable[Part]], function: Callable[[Any], Part], items: Sequence[Any],
    name: str,
) -> list[Part]:  # fmt: skip
    """Collect parts and print the progress."""
    done = []
    for part in run(function, items):
        done.append(part)
        print(f"\r{name}: {len(done)} of {len(items)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return done
