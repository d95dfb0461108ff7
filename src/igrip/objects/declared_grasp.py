"""Grasps that a user declares for an object, in ``objects.toml``."""

from __future__ import annotations

import math

import numpy as np
from pydantic import field_validator, model_validator

from igrip.settings import Settings, quantity
from igrip.taxonomy import NAMES

Triple = tuple[float, float, float]


class DeclaredGrasp(Settings):
    """One way to grasp an object, ``[[NAME.grasps]]`` of ``objects.toml``.

    In the frame that the object's poses refer to, in metres and radians, whatever the unit of the
    mesh.

    Attributes
    ----------
    grip : str
        One of :data:`igrip.taxonomy.NAMES`.
    part : str
        What it takes, for people.
    point : 3 floats
        Midway between thumb and fingers [m].
    approach, closing : 3 floats
        The way of the palm to the point, and from the thumb to the fingers.
    pivot, axis : 3 floats, optional
        A line about which the grasp may be turned; the point lies on it by default.
    """

    grip: str
    part: str = "declared"
    point: Triple
    approach: Triple
    closing: Triple
    opening: float = quantity(0.0, "m", "between thumb and fingers", "the user", ge=0, le=0.2)
    depth: float = quantity(0.0, "m", "from the surface to the point", "the user", ge=0, le=0.2)
    weight: float = quantity(1.0, "1", "how readily it is taken, against the others", gt=0)
    pivot: Triple | None = None
    axis: Triple | None = None
    turn: float = quantity(
        0.0, "rad", "it may be turned about the axis by so much to both sides", ge=0, le=math.pi
    )

    @field_validator("grip")
    @classmethod
    def _known(cls, grip: str) -> str:
        if grip not in NAMES:
            raise ValueError(f"there is no grip {grip!r:.40}; there are: {', '.join(NAMES)}")
        return grip

    @model_validator(mode="after")
    def _spans_a_hand(self) -> DeclaredGrasp:
        sizes = np.linalg.norm([self.approach, self.closing], axis=1)
        aside = float(np.linalg.norm(np.cross(self.approach, self.closing)))
        if not aside > 0.1 * float(sizes.prod()) > 0.0:
            raise ValueError("approach and closing must be two directions across one another")
        if self.turn > 0.0 and self.axis is None:
            raise ValueError("turn needs an axis")
        if self.axis is not None and not np.linalg.norm(self.axis) > 1e-9:
            raise ValueError("axis has no direction")
        return self
