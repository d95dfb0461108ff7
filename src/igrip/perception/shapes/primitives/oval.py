"""``oval``: an upright cylinder or cone with an ellipse for its foot, as many bottles have."""

from __future__ import annotations

import numpy as np
import trimesh

from igrip.objects.model import Symmetry
from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays, entered
from igrip.perception.shapes.primitives._cone import (
    SECTIONS,
    Cone,
    cone_of,
    flatness_prior,
    flattened,
    inside,
)
from igrip.rgbd import Array

ROUNDEST, FLATTEST = 0.95, 0.3  # shorter over longer axis


@PRIMITIVES.register("oval")
class Oval:
    """An upright cone, flattened.

    Parameters: x, y, logarithms of the longer half axis at the top, of foot over top, of the
    height; the logarithm of shorter over longer axis, and the yaw of the longer one.
    """

    symmetry: Symmetry = "box"
    axis = None
    cost = 0.016
    steps = np.array([0.008, 0.008, 0.12, 0.12, 0.06, 0.15, 0.2])
    wall = None

    def start(self, footprint: Footprint) -> Array:
        """See :class:`igrip.perception.shapes.primitives.Primitive`, as for all methods."""
        longer, shorter = np.maximum(footprint.half, 0.005)
        return np.array([
            *footprint.middle, np.log(longer), 0.0, np.log(footprint.height),
            np.log(np.clip(shorter / longer, FLATTEST, ROUNDEST)), footprint.yaw,
        ])  # fmt: skip

    def depths(self, parameters: Array, rays: Rays) -> Array:
        """Where rays enter a cone; the shorter axis is stretched until it is round."""
        cone, flat, yaw = _sizes(parameters)
        turned = flattened(rays, cone.x, cone.y, yaw, flat)
        near, far, _ = inside(cone._replace(x=0.0, y=0.0), turned)
        return entered(near, far)

    def unlikely(self, parameters: Array) -> float:
        """By how flat it is: its back is not seen."""
        return flatness_prior(_sizes(parameters)[1])

    def height(self, parameters: Array) -> float:
        """Of its top."""
        return _sizes(parameters)[0].height

    def radii(self, parameters: Array, heights: Array, angles: Array) -> Array:
        """Of an ellipse, larger or smaller at each height."""
        cone, flat, yaw = _sizes(parameters)
        across = cone.low + (cone.top - cone.low) * np.minimum(heights / cone.height, 1.0)
        turned = angles - yaw
        round_one = 1.0 / np.hypot(np.cos(turned), np.sin(turned) / flat)
        return np.asarray(across[:, None] * round_one[None, :])

    def mesh(self, parameters: Array) -> trimesh.Trimesh:
        """Return a surface of revolution, stretched and turned."""
        cone, flat, yaw = _sizes(parameters)
        _, _, low, top, h = cone
        middle = (0.5 * (low + top), 0.5 * h)
        profile = np.array([(0.0, 0.0), (low, 0.0), middle, (top, h), (0.0, h)])
        mesh = trimesh.creation.revolve(profile, sections=SECTIONS)
        mesh.apply_scale((1.0, flat, 1.0))
        mesh.apply_transform(trimesh.transformations.rotation_matrix(yaw, (0, 0, 1)))
        return mesh


def _sizes(parameters: Array) -> tuple[Cone, float, float]:
    flat = float(np.clip(np.exp(parameters[5]), FLATTEST, ROUNDEST))
    return cone_of(parameters[:5]), flat, float(parameters[6])
