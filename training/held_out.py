"""Real reaches that nothing is learned from: they check what was learned elsewhere.

Each folder of the shared data holds ``trials.parquet`` (trial, target, places, onset_s, end_s) and
``reaches.parquet`` (trial, t, x, y, z). The sensor has 30 Hz and 4 mm of noise; the
mustard bottle stands at each place, and candidates keep 9 cm from the path, as real objects would.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.observation import Observation
from training.moments import Recording, catalog

Array = NDArray[np.float64]
RATE, NOISE = 30.0, 0.004  # Hz, m each axis
CLEARANCE = 0.09  # m, that the path keeps from what is not its target
MODEL = "006_mustard_bottle"
BEFORE, AFTER = 0.3, 0.2  # s of the recording that are kept before onset and after end
CANDIDATES = 4  # of the set with one place
NAMES = ("exo_plane", "aiming_two", "grasp_depths")


def held_out(shared: Path, name: str, seed: int = 1) -> Iterator[Recording]:
    """Yield the reaches of one set.

    Parameters
    ----------
    shared : Path
        Folder that holds the sets.
    name : str
        One of :data:`NAMES`.
    seed : int
        Of the noise, and of places that are made up.
    """
    random = np.random.default_rng(seed)
    samples = dict(list(pd.read_parquet(shared / name / "reaches.parquet").groupby("trial")))
    for row in pd.read_parquet(shared / name / "trials.parquet").to_dict("records"):
        table = samples[row["trial"]]
        palms = table[["x", "y", "z"]].to_numpy()
        good = np.isfinite(palms).all(axis=1)
        times, palms = table["t"].to_numpy()[good], palms[good]
        moving = (times >= row["onset_s"]) & (times <= row["end_s"])
        places = np.array(json.loads(str(row["places"])), dtype=np.float64)
        target = places[int(row["target"])]
        rivals = [p for k, p in enumerate(places) if k != int(row["target"])]
        if not rivals:
            rivals = _made_up(target, palms[moving], random)
        rivals = [p for p in rivals if _gap(palms[moving], p) >= CLEARANCE]
        first, last = max(times[0], row["onset_s"] - BEFORE), min(times[-1], row["end_s"] + AFTER)
        even = np.arange(math.ceil(first * RATE), math.floor(last * RATE) + 1) / RATE
        seen = np.stack([np.interp(even, times, palms[:, axis]) for axis in range(3)], axis=1)
        seen += random.normal(0.0, NOISE, seen.shape)
        objects = {f"o{k}": _pose(place) for k, place in enumerate([target, *rivals])}
        messages = [
            Observation(
                t=float(t), hands={"right": {"position": palm}}, objects=objects if k == 0 else {}
            )
            for k, (t, palm) in enumerate(zip(even, seen.tolist(), strict=True))
        ]
        yield Recording(
            str(row["participant"]), name, messages, "right", "o0", float(row["onset_s"]),
            float(row["end_s"]), math.inf, RATE,
        )  # fmt: skip


def _gap(path: Array, place: Array) -> float:
    return float(np.linalg.norm(path - place, axis=1).min())


def _made_up(target: Array, path: Array, random: np.random.Generator) -> list[Array]:
    """Return places beside the path, for a set that has only its target's."""
    places: list[Array] = []
    for _ in range(200):
        place = target + random.uniform(-0.3, 0.3, 3) * [1.0, 1.0, 0.3]
        apart = min(float(np.linalg.norm(place - p)) for p in [target, *places])
        if apart > 0.12 and _gap(path, place) >= CLEARANCE:
            places.append(place)
        if len(places) == CANDIDATES - 1:
            break
    return places


def _pose(place: Array) -> ObjectPose:
    """Return the pose that puts the middle of the mesh's cylinder at a place."""
    position = tuple((place - catalog()[MODEL].origin).tolist())
    return ObjectPose(model=MODEL, position=position, orientation=(0.0, 0.0, 0.0, 1.0), static=True)
