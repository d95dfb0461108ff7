"""Fit of the field's methods to the same people: Gaussians, a mixture, templates."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.mixture import GaussianMixture

from igrip.targets.learned.reach_library import FORMAT, ReachFrames
from training.moments import Frames, Recording

Array = NDArray[np.float64]
STEP, MAX_DURATION = 1.0 / 30.0, 2.0  # s
COMPONENTS = 12
TEMPLATES = 160
DIGITS = 6


@dataclass(frozen=True)
class Demonstration:
    """One reach as it was demonstrated, from onset to end.

    Attributes
    ----------
    elapsed : (n,), place : (n, 2)
        Since the onset [s], and progress and deviation in the frame of the reach.
    speed : (n,)
        Of the hand [m/s].
    distance : float
        From start to end [m].
    """

    elapsed: Array
    place: Array
    speed: Array
    distance: float


def demonstrated(recording: Recording, frames: Frames) -> Demonstration | None:
    """Return a reach in its own frame; None if its beginning was not observed."""
    reaches = ReachFrames()
    elapsed: list[float] = []
    place: list[Array] = []
    speed: list[float] = []
    distance = 0.0
    for motion, geometry in frames:
        reach = reaches.update(motion, geometry)
        ids = [placed.id for placed in geometry.objects]
        within = recording.onset - 0.2 <= motion.t <= recording.end
        if reach is None or not within or recording.target not in ids:
            continue
        if elapsed and reach.elapsed < elapsed[-1]:  # it stopped on the way: begin anew
            elapsed, place, speed = [], [], []
        elapsed.append(reach.elapsed)
        place.append(reach.place[ids.index(str(recording.target))])
        position, velocity, _ = motion.reach.now
        speed.append(float(np.linalg.norm(velocity)))
        distance = float(np.linalg.norm(position - motion.reach.start))
    if len(elapsed) < 5:
        return None
    return Demonstration(np.array(elapsed), np.array(place), np.array(speed), distance)


def fit_library(shown: Sequence[Demonstration], seed: int) -> dict[str, Any]:
    """Return what the three methods learn."""
    return {
        "format": FORMAT,
        "gaussians": _gaussians(shown),
        "mixture": _mixture(shown, seed),
        "templates": _templates(shown, seed),
    }


def _gaussians(shown: Sequence[Demonstration]) -> dict[str, Any]:
    mean, covariance = [], []
    for step in STEP * np.arange(int(MAX_DURATION / STEP)):
        at = []
        for one in shown:
            # who has arrived stays there
            at.append([np.interp(step, one.elapsed, one.place[:, k]) for k in range(2)])
        places = np.array(at)
        mean.append(np.round(places.mean(axis=0), DIGITS).tolist())
        spread = np.cov(places.T) + 1e-4 * np.eye(2)
        covariance.append(np.round(spread, DIGITS).tolist())
    return {"step_s": STEP, "mean": mean, "covariance": covariance}


def _mixture(shown: Sequence[Demonstration], seed: int) -> dict[str, Any]:
    every = np.concatenate(
        [
            np.column_stack([one.elapsed, one.place])[:: max(1, len(one.elapsed) // 12)]
            for one in shown
        ]
    )
    model = GaussianMixture(COMPONENTS, tol=1e-7, max_iter=2000, reg_covar=1e-4, random_state=seed)
    model.fit(every[(every[:, 0] <= MAX_DURATION) & (np.abs(every[:, 1:]) < 3.0).all(axis=1)])
    return {
        "weight": np.round(model.weights_, DIGITS).tolist(),
        "mean": np.round(model.means_, DIGITS).tolist(),
        "covariance": np.round(model.covariances_, DIGITS).tolist(),
    }


def _templates(shown: Sequence[Demonstration], seed: int) -> dict[str, Any]:
    chosen = np.random.default_rng(seed).permutation(len(shown))[:TEMPLATES]
    times = STEP * np.arange(int(MAX_DURATION / STEP))
    speeds = [
        np.interp(times, shown[k].elapsed, shown[k].speed, left=0.0, right=0.0) for k in chosen
    ]
    return {
        "step_s": STEP,
        "speed": np.round(speeds, 3).tolist(),
        "distance": [round(shown[k].distance, 4) for k in chosen],
    }


def write_library(content: dict[str, Any], path: Path) -> None:
    """Write what was learned, a line for each number or row."""
    lines = []
    for name, part in content.items():
        if not isinstance(part, dict) or name == "provenance":
            lines.append(f' "{name}": {json.dumps(part)}')
            continue
        rows = []
        for key, value in part.items():
            one = isinstance(value, float) or not isinstance(value[0], list)
            text = (
                json.dumps(value)
                if one
                else "[\n   " + ",\n   ".join(map(json.dumps, value)) + "\n  ]"
            )
            rows.append(f'  "{key}": {text}')
        lines.append(f' "{name}": {{\n' + ",\n".join(rows) + "\n }")
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
