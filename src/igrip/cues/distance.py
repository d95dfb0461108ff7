"""Distance: which object the hand is near (paper: Eq. 4)."""

from __future__ import annotations

import numpy as np

from igrip.cues.base import CueConfig, Scores, cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@cue("distance", order=0)
def distance(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``1 - min(d / d_max, 1)``, in [0, 1].

    d is the distance to the nearest vertex (the paper) or surface point. The paper prints ``max``,
    which makes every value ≤ 0 (SPEC §5).
    """
    away = geometry.vertex if config.distance == "vertex" else geometry.surface
    return 1.0 - np.minimum(away / config.spread(geometry), 1.0)
