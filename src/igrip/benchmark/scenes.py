"""The scenes that are timed: two hands that reach, and as many objects as asked for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from igrip.objects.catalog import PAPER_OBJECTS
from igrip.observation import Observation
from igrip.simulation.minimum_jerk import reach

RATE = 30.0
NOISE = 0.002  # sd of every position [m]: no two frames are alike, as with a real sensor


def frames(
    count: int,
    objects: int = 4,
    hands: int = 2,
    models: Sequence[str] = PAPER_OBJECTS,
    seed: int = 0,
) -> list[Observation]:
    """Return messages at 30 Hz in which every hand and object is measured.

    Parameters
    ----------
    count : int
        Number of messages.
    objects, hands : int
        How many there are. Objects stand on a table that grows with their number, so that they are
        as dense as on the table of the paper.
    models : sequence of str
        Models of the objects, in turn.
    seed : int
        Of places and noise.
    """
    random = np.random.default_rng(seed)
    side = max(1, math.ceil(math.sqrt(objects)))
    places = [
        np.array([0.25 * (k % side - 0.5 * (side - 1)), 0.35 + 0.25 * (k // side), 0.0])
        for k in range(objects)
    ]
    turns = random.uniform(-math.pi, math.pi, objects)
    starts = [np.array([0.3 * (h - 0.5 * (hands - 1)), 0.0, 0.05]) for h in range(hands)]
    goals = [places[h % objects] + [0.0, 0.0, 0.1] for h in range(hands)]
    messages = []
    for k in range(count):
        part = np.array([1.0 - abs(1.0 - (k % 72) / 36.0)])  # there in 1.2 s and back
        messages.append(
            Observation(
                t=k / RATE,
                hands={
                    f"hand{h}": {
                        "position": reach(starts[h], goals[h], 0.05, part)[0]
                        + random.normal(0.0, NOISE, 3)
                    }
                    for h in range(hands)
                },
                objects={
                    f"object{o}": {
                        "model": models[o % len(models)],
                        "position": place + random.normal(0.0, NOISE, 3),
                        "orientation": [0.0, 0.0, math.sin(turns[o] / 2), math.cos(turns[o] / 2)],
                    }
                    for o, place in enumerate(places)
                },
            )
        )
    return messages
