"""Real hands that work and reach for none of the objects.

The recordings hold palms only, so objects are put where the hand never goes.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.observation import Observation
from training.moments import THINGS, Recording, catalog

Array = NDArray[np.float64]
SECONDS = 8.0  # of one example
MIN_SECONDS = 2.0
MAX_GAP = 0.2  # s; after a longer one another example begins
LEARNED_FROM = 2  # every second recording session; the others judge
CLEARANCE, APART = 0.13, 0.1  # m from the palm's path, from each other
COUNTS = (2, 3, 4, 4, 6)


def hands_at_work(folder: Path, seed: int, learned: bool) -> Iterator[Recording]:
    """Yield stretches of the sessions that are learned from, or of the others."""
    trials = pd.read_parquet(folder / "trials.parquet")
    sessions = sorted(set(trials["participant"]))
    chosen = {s for k, s in enumerate(sessions) if (k % LEARNED_FROM == 0) == learned}
    samples = dict(list(pd.read_parquet(folder / "reaches.parquet").groupby("trial")))
    for row in trials[trials["participant"].isin(chosen)].to_dict("records"):
        seen = samples[row["trial"]]
        seen = seen[seen["valid"].astype(bool)]
        times, palms = seen["t"].to_numpy(), seen[["x", "y", "z"]].to_numpy()
        random = np.random.default_rng(
            [seed, zlib.crc32(f"{row['participant']} {row['trial']}".encode())]
        )
        for first, last in _stretches(times):
            example = _example(
                times[first:last], palms[first:last], str(row["participant"]), random
            )
            if example is not None:
                yield example


def _stretches(times: Array) -> Iterator[tuple[int, int]]:
    """Yield first and last (exclusive) sample of stretches without a gap."""
    cuts = np.flatnonzero(np.diff(times) > MAX_GAP) + 1
    for begin, end in zip([0, *cuts], [*cuts, len(times)], strict=True):
        first = int(begin)
        while first < end:
            last = int(np.searchsorted(times[:end], times[first] + SECONDS))
            if times[last - 1] - times[first] > MIN_SECONDS:
                yield first, last
            first = last


def _example(
    times: Array, palms: Array, person: str, random: np.random.Generator
) -> Recording | None:
    """Return one stretch with objects beside it; None where there is no room for any."""
    count = int(random.choice(COUNTS))
    low, high = palms.min(axis=0) - 0.3, palms.max(axis=0) + 0.3
    places: list[Array] = []
    for _ in range(300):
        place = random.uniform(low, high)
        free = np.linalg.norm(palms - place, axis=1).min() > CLEARANCE
        if free and all(np.linalg.norm(place - other) > APART for other in places):
            places.append(place)
        if len(places) == count:
            break
    if not places:
        return None
    objects = {}
    for k, place in enumerate(places):
        model = catalog()[THINGS[int(random.integers(len(THINGS)))]]
        position = tuple((place - model.origin).tolist())
        upright = (0.0, 0.0, 0.0, 1.0)
        objects[f"o{k}"] = ObjectPose(
            model=model.name, position=position, orientation=upright, static=True
        )
    messages = [
        Observation(
            t=float(t - times[0]),
            hands={"right": {"position": palm}},
            objects=objects if k == 0 else {},
        )
        for k, (t, palm) in enumerate(zip(times, palms.tolist(), strict=True))
    ]
    never = math.inf
    return Recording(person, "work", messages, "right", None, never, never, never, 30.0)
