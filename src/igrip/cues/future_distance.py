"""Future distance: which object the hand will soon be near (paper: Eq. 5)."""

from __future__ import annotations

from igrip.cues import CueConfig, Scores, cue
from igrip.cues.distance import closeness
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


@cue("future_distance", order=0)
def future_distance(motion: Motion, geometry: Geometry, config: CueConfig) -> Scores:
    """Score ``1 - min(d / d_max, 1)``, in [0, 1], d from the barycentre of the predicted points.

    The paper prints ``max``, as for the distance (decision 0013).
    """
    distances = geometry.future_vertex if config.distance == "vertex" else geometry.future_surface
    scores: Scores = closeness(distances, config.spread(geometry))
    return scores
