"""Reaches made of a minimum jerk, for tests of what watches them."""

from __future__ import annotations

import numpy as np

import igrip
from igrip.lab.simulation.minimum_jerk import reach
from support import CAN, UPRIGHT

START = np.array([0.0, 0.0, 0.05])
TWO = {"near": np.array([0.0, 0.25, 0.05]), "far": np.array([0.0, 0.47, 0.05])}
SPREAD = {"left": np.array([-0.2, 0.4, 0.05]), "right": np.array([0.2, 0.4, 0.05])}


def reach_messages(goal, objects, rate=30.0, rest=0.5, lasts=0.9, hold=0.5, noise=0.0, lift=0.05,
                   model=CAN, seed=0, start=START):  # fmt: skip
    """Return messages of a hand that rests, reaches and stays; and onset and end [s]."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, rest + lasts + hold, 1.0 / rate)
    points = reach(np.array(start), np.array(goal), lift, (times - rest) / lasts)
    points = points + noise * rng.normal(size=points.shape)
    poses = {
        id: {"model": model, "position": list(place), "orientation": UPRIGHT, "static": True}
        for id, place in objects.items()
    }
    messages = [
        {"t": float(t), "hands": {"right": {"position": point.tolist()}}, "objects": {}}
        for t, point in zip(times, points, strict=True)
    ]
    messages[0]["objects"] = poses
    return messages, rest, rest + lasts


def intentions_of(messages, catalog, targets="bayes", **config):
    """Return all intentions of the right hand."""
    estimator = igrip.Estimator(catalog, igrip.Config(targets=targets, **config))
    every = [i for m in messages for i in estimator.update(igrip.Observation(**m))]
    return [i for i in every if i.hand == "right"]


def at(intentions, t):
    """Return the newest intention at a time."""
    return [i for i in intentions if i.t <= t + 1e-9][-1]
