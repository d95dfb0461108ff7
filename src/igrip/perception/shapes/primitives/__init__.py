"""Simple shapes that unknown things are fitted with: box, cylinder, sphere, and one that lies.

Each rests on the table z = 0 (z up). A member has one file; its parameters are an array that an
optimiser may change at will, lengths as logarithms.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.registry import Registry
from igrip.rgbd import Array

__all__ = ["PRIMITIVES", "Footprint", "Primitive", "Rays"]


class Rays(NamedTuple):
    """Lines of sight, in the frame of the table [m]."""

    origin: Array  # (3,), the camera
    directions: Array  # (m, 3); so long that the depth along the optical axis grows by 1


class Footprint(NamedTuple):
    """The rectangle of least area round what a thing covers of the table, and its height."""

    middle: Array  # (2,) [m]
    yaw: float  # of its longer edge [rad]
    half: Array  # (2,), half of the longer and of the shorter edge [m]
    height: float  # of the thing [m]


class Primitive(Protocol):
    """A kind of shape."""

    @property
    def symmetry(self) -> Symmetry:
        """Of its mesh, see :class:`igrip.objects.model.ObjectModel`."""
        ...

    @property
    def axis(self) -> Array | None:
        """Axis of its model, (3,); None: its longest edge."""
        ...

    @property
    def cost(self) -> float:
        """What is added to its misfit, for what it can do more than others."""
        ...

    @property
    def steps(self) -> Array:
        """By which a search begins to change the parameters, (n,)."""
        ...

    @property
    def wall(self) -> float | None:
        """Thickness of its wall, if it is open at the top [m]; None: it is closed."""
        ...

    def start(self, footprint: Footprint) -> Array:
        """Return parameters (n,) of about this size; the first two are x and y of its middle."""
        ...

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Return at which depth each ray meets it, (m,) [m]; infinity: it does not."""
        ...

    def unlikely(self, parameters: Array) -> float:
        """Return what is added to its misfit, for proportions that are rare."""
        ...

    def height(self, parameters: Array) -> float:
        """Return its height [m]."""
        ...

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Return how far its surface is from the vertical through its middle, (k, n) [m].

        At heights (k,) over the table [m] and angles (n,) [rad].
        """
        ...

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return it as a closed mesh; its origin is on the table under its middle [m]."""
        ...


PRIMITIVES: Registry[Callable[[], Primitive]] = Registry(
    "shape", "igrip.perception.shapes.primitives", "igrip.shapes"
)
"""By name; a member is called without arguments."""


def slab(near: Array, far: Array, origin: float, direction: Array, half: float) -> None:
    """Narrow where rays are inside (m,) to where one coordinate is within ``half``; in place."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (-half - origin) / direction, (half - origin) / direction
    np.maximum(near, np.fmin(a, b), out=near)
    np.minimum(far, np.fmax(a, b), out=far)


def entered(near: Array, far: Array) -> Array:
    """Return where rays enter, (m,); infinity: they miss."""
    return np.where((near < far) & (near > 0.0), near, np.inf)
