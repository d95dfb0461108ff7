"""Ray impacts: which object the predicted path points at (paper: Eq. 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.cues import CueConfig, Scores, cue
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@kernel
def shares(hits: NDArray[np.int64]) -> Scores:
    """Return the share of each in the sum of all; 0 where that is 0."""
    scores: Scores = hits / max(1, hits.sum())
    return scores


@cue("impacts", order=1)
def impacts(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``n_j / Σ n``, in [0, 1]; 0 for all where no ray meets anything (decision 0013)."""
    scores: Scores = shares(geometry.hits)
    return scores
