"""The distance of the predicted hand decides alone (paper: Eq. 10)."""

from __future__ import annotations

from functools import partial

from igrip.targets import TARGETS
from igrip.targets._weighted_cues import SingleCue

TARGETS.register("future_distance")(partial(SingleCue, "future_distance"))
