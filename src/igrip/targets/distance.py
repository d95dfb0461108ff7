"""The distance of the hand decides alone, for comparison (paper: Eq. 10)."""

from __future__ import annotations

from functools import partial

from igrip.targets import TARGETS
from igrip.targets._weighted_cues import SingleCue

TARGETS.register("distance")(partial(SingleCue, "distance"))
