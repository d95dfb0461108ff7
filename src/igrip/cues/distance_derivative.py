"""Distance derivative: which object the hand comes nearer to, and how directly (paper: Eq. 3)."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.cues import CueConfig, Scores, cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@kernel
def directness(rates: Scores, speed: float) -> Scores:
    """Return ``-ḋ / v`` of each rate ḋ.

    Straight at the centre of a resting object rounding may leave [-1, 1] by some digits; there it
    is 1 or -1.
    """
    scores = np.empty(len(rates))
    for o, rate in enumerate(rates):
        score = -rate / speed
        rounded = 1.0 < abs(score) < 1.0 + 1e-9
        scores[o] = np.sign(score) if rounded else score
    return scores


@cue("distance_derivative", order=1)
def distance_derivative(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``-ḋ / v``, in [-1, 1] for resting objects; 0 below ``min_speed``.

    d is the distance to the centre of gravity. The paper prints ``ḋ / v``, which would choose the
    object that recedes fastest (decision 0013).
    """
    if motion.speed < config.min_speed or motion.speed == 0.0:
        return np.zeros(len(geometry.centre_rate))
    scores: Scores = directness(geometry.centre_rate, motion.speed)
    return scores
