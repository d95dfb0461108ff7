"""Grip selectors: from the position of a hand beside its target to the grip for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion
from igrip.registry import Registry
from igrip.settings import Settings, quantity
from igrip.targets import TargetEstimate


class GripConfig(Settings):
    """Parameters of the grip selectors."""

    pinch_threshold: float = quantity(
        0.85,
        "half-lengths",
        "a hand at least this far along the axis pinches",
        "paper: Eq. 11",
        gt=0,
    )
    sure: float = quantity(
        0.95, "probability", "contact chooses a grip that is at least this likely against the "
        "paper's rule; 0.5: whichever is likelier",
        "python -m training.grip_check; docs/estimators.md", ge=0.5, le=1,
    )  # fmt: skip


class Grip(NamedTuple):
    """A grip, and the probability of each where the selector is calibrated."""

    name: str | None
    probability: Mapping[str, float] | None = None


class GripSelector(Protocol):
    """Selects the grip of one hand."""

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return the grip for the estimated target."""
        ...


GRIPS: Registry[Callable[[GripConfig], GripSelector]] = Registry("grip selector", "igrip.grips")
