"""The scenes that are timed: reaching hands, and as many objects as wanted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from igrip.lab.simulation.minimum_jerk import reach
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.observation import Observation

RATE = 30.0  # messages per second
NOISE = 0.002  # sd of every position [m]: no two frames are alike, as with a real sensor


def frames(
    count: int,
    objects: int = 4,
    hands: int = 2,
    models: Sequence[str] = PAPER_OBJECTS,
    seed: int = 0,
) -> list[Observation]:
    """Return messages at 30 Hz in which every hand and object is measured.

    The table grows with the number of objects, so that they stay as dense as on the table of the
    paper; they have these models by turns.
    """
    random = np.random.default_rng(seed)
    # the first four places never move: the hands reach for two of them, whatever stands around
    rings = sorted(
        (max(abs(2 * i - 1), abs(2 * j - 1)), j, i) for i, j in product(range(-6, 8), range(-1, 13))
    )
    places = [np.array([0.25 * (i - 0.5), 0.35 + 0.25 * j, 0.0]) for _, j, i in rings[:objects]]
    turns = random.uniform(-math.pi, math.pi, objects)
    starts = [np.array([0.3 * (h - 0.5 * (hands - 1)), 0.0, 0.05]) for h in range(hands)]
    goals = [places[h % min(objects, 2)] + [0.0, 0.0, 0.1] for h in range(hands)]
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
