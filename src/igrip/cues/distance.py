"""Distance: which object the hand is near (paper: Eq. 4)."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.cues import CueConfig, Scores, cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@kernel
def closeness(distances: Scores, spread: float) -> Scores:
    """Return ``1 - min(d / d_max, 1)`` of each distance."""
    scores: Scores = 1.0 - np.minimum(distances / spread, 1.0)
    return scores


@cue("distance", order=0)
def distance(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``1 - min(d / d_max, 1)``, in [0, 1].

    d is the distance to the nearest vertex (the paper) or surface point. The paper prints ``max``,
    which makes every value ≤ 0 (decision 0013).
    """
    distances = geometry.vertex if config.distance == "vertex" else geometry.surface
    scores: Scores = closeness(distances, config.spread(geometry))
    return scores
