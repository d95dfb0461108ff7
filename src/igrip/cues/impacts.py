"""Ray impacts: which object the predicted path points at (paper: Eq. 2)."""

from __future__ import annotations

import numpy as np

from igrip.cues.base import CueConfig, Scores, cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@cue("impacts", order=1)
def impacts(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``n_j / Σ n``, in [0, 1]; 0 for all where no ray meets anything (SPEC §5)."""
    total = int(geometry.hits.sum())
    return geometry.hits / total if total else np.zeros(len(geometry.hits))
