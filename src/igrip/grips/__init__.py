"""Grip selectors: from the position of a hand beside its target to the grip for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from igrip.entities import Vector
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
    palm_std: float = quantity(
        0.03, "m", "candidates: the palm at contact is this near to where a candidate has it",
        "python -m benchmarks.measure_grasps; docs/grips.md", gt=0,
    )  # fmt: skip
    heading_weight: float = quantity(
        1.0, "log-odds", "candidates: of a hand that moves along a candidate's approach", "guess",
        ge=0,
    )  # fmt: skip
    pointing_weight: float = quantity(
        3.0, "log-odds", "candidates: of a hand that points along it", "guess", ge=0
    )
    turn_weight: float = quantity(
        3.0, "log-odds", "candidates: of a hand whose fingers close as the candidate's", "guess",
        ge=0,
    )  # fmt: skip


class Grasp(NamedTuple):
    """How the target will be grasped, where a selector says more than the grip. World frame.

    Attributes
    ----------
    contact : 3 floats
        Midway between thumb and fingers [m].
    aperture : float
        Between them [m].
    wrist, wrist_std : float
        Rotation of the hand about the approach and its standard deviation [rad]; see
        :class:`igrip.intention.Intention`.
    """

    contact: Vector
    aperture: float
    wrist: float
    wrist_std: float


class Grip(NamedTuple):
    """A grip, the probability of each where the selector is calibrated, and what else is known."""

    name: str | None
    probability: Mapping[str, float] | None = None
    grasp: Grasp | None = None


class GripSelector(Protocol):
    """Selects the grip of one hand."""

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return the grip for the estimated target."""
        ...


GRIPS: Registry[Callable[[GripConfig], GripSelector]] = Registry("grip selector", "igrip.grips")
