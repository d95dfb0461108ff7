"""What the estimators learn from, source by source, through the estimator's own stages."""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.io.importers import RecordedReach
from igrip.targets.learned.timing import INPUTS
from training.arms import simulate_arm
from training.grip import approaches_of
from training.handovers import simulate_handovers
from training.hands_at_work import hands_at_work
from training.library import Demonstration, demonstrated
from training.moments import Moments, Recording, follow, joined, moments_of
from training.people import EACH, FOLDS, LEARNED_FROM, real_recordings, record
from training.timing import TimingSamples, join_timing, timing_samples
from training.worlds import simulate_person

Array = NDArray[np.float64]
SEED = 20260
PERSONS = {"worlds": 720, "arms": 480, "handovers": 240}  # of each generator
WEIGHTS = {"near_far": 3.0, "worlds": 2.0, "arms": 1.0, "handovers": 1.5, "work": 2.0}
"""Weight of all moments of each source (docs/estimators.md has the alternatives)."""
NO_TIMING = TimingSamples(np.empty((0, len(INPUTS))), np.empty((0, 2)), np.empty(0))
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
    return Part(joined(moments), join_timing(timing or [NO_TIMING]), demonstrations, approaches)


def joined_parts(parts: Sequence[Part]) -> Part:
    """Return what is learned from several parts as one."""
    return Part(
        joined([p.moments for p in parts]), join_timing([p.timing for p in parts]),
        [x for p in parts for x in p.demonstrations], [x for p in parts for x in p.approaches],
    )  # fmt: skip


def near_far_fold(fold: int) -> str:
    """Return the name of one fold of the near/far people: a source of its own."""
    return f"near_far {fold}"


def kind_of(name: str) -> str:
    """Return the kind of a source: the folds of the near/far people are one kind."""
    return name.split(" ")[0]


def source_weight(name: str, names: Sequence[str]) -> float:
    """Return the weight of a source among others; those of a kind share the kind's."""
    kind = kind_of(name)
    return WEIGHTS[kind] / sum(kind_of(other) == kind for other in names)


def provenance(shared: Path) -> dict[str, Any]:
    """Return what is learned from."""
    files = [
        f for name in ("wispinski2021", "hands_at_work") for f in (shared / name).glob("*.parquet")
    ]
    return {
        "made_by": "python -m training (docs/estimators.md)",
        "real": f"Wispinski et al. 2021; {FOLDS - 1} of {FOLDS} folds of people, "
        f"at most {EACH} reaches of each",
        "work": "HoloLens 2 hands at work (Gigi-G, MIT), every second session",
        "tables": {
            f"{f.parent.name}/{f.name}": hashlib.sha256(f.read_bytes()).hexdigest()[:16]
            for f in sorted(files)
        },
        "simulated": ", ".join(
            f"{count} people of training/{name}.py" for name, count in PERSONS.items()
        ),
        "weights": WEIGHTS,
        "seed": SEED,
    }


def _real(jobs: Sequence[tuple[RecordedReach, int]]) -> Part:
    return part_of(record(*job) for job in jobs)


def _world(number: int) -> Part:
    return part_of(simulate_person(SEED, number))


def _arm(number: int) -> Part:
    part = part_of(simulate_arm(SEED, number))
    return part._replace(demonstrations=[])  # the field's methods learn from the other sources


def _handovers(number: int) -> Part:
    return part_of(simulate_handovers(SEED, number))._replace(demonstrations=[])


def _work(recordings: Sequence[Recording]) -> Part:
    return part_of(recordings)


def gather(
    shared: Path, cache: Path | None = None, folds: Sequence[int] = LEARNED_FROM,
    persons: Mapping[str, int] = PERSONS,
) -> dict[str, Part]:  # fmt: skip
    """Return what is learned from each source, by name.

    Parameters
    ----------
    shared : Path
        Folder with the near/far reaches (``wispinski2021``) and the ``hands_at_work``.
    cache : Path, optional
        A file that keeps the result for the next call.
    folds : sequence of int
        Folds of the people of the near/far reaches.
    persons : mapping of str to int
        Simulated people of each generator, ``worlds``, ``arms`` and ``handovers``.
    """
    if cache is not None and cache.exists():
        kept: dict[str, Part] = pickle.loads(cache.read_bytes())
        return kept
    tables, work = shared / "wispinski2021", shared / "hands_at_work"
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
            ("worlds", _world, range(persons["worlds"])),
            ("arms", _arm, range(persons["arms"])),
            ("handovers", _handovers, range(persons["handovers"])), ("work", _work, stretches),
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
