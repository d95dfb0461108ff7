"""The share of predicted rays that meet an object decides alone (paper: Eq. 10)."""

from __future__ import annotations

from functools import partial

from igrip.targets import TARGETS
from igrip.targets._weighted_cues import SingleCue

TARGETS.register("impacts")(partial(SingleCue, "impacts"))
