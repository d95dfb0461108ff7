"""The test that every candidate found has to pass, on the mesh itself instead of its sample."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.grasps.candidate import Candidate
from igrip.grasps.opposition import FRICTION_ANGLE, MAX_OPENING
from igrip.mesh.bvh import STACK, Bvh
from igrip.mesh.ray import cast_ray

Array = NDArray[np.float64]

BEFORE = 0.02  # m; from so far outside a finger comes to its contact
OFF = 0.006  # m; contacts lie so near to the mesh
PATCH = 0.008  # m; of the surface under a fingertip
ASIDE = math.cos(math.radians(60.0))  # faces that look further aside belong to another side


class HoldTest:
    """Nguyen's test of two contacts with friction on the triangles of a mesh.

    Parameters
    ----------
    vertices, faces : (v, 3), (f, 3)
        The mesh [m].
    bvh : Bvh
        Tree of its triangles.
    """

    def __init__(self, vertices: Array, faces: NDArray[np.int64], bvh: Bvh) -> None:
        corners = vertices[faces]
        self._centres = corners.mean(axis=1)
        self._oriented = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self._size = np.linalg.norm(self._oriented, axis=1)
        self._bvh = bvh
        self._stack, self._counters = np.empty(STACK, np.int32), np.zeros(3, np.int64)

    def holds(self, candidate: Candidate) -> bool:
        """Return whether the line between the contacts lies in both friction cones."""
        if candidate.opening > MAX_OPENING:
            return False
        sides = zip(candidate.contacts, (-candidate.closing, candidate.closing), strict=True)
        return all(self._presses(contact, outward) for contact, outward in sides)

    def _presses(self, contact: Array, outward: Array) -> bool:
        begin = contact + BEFORE * outward
        t = cast_ray(*self._bvh, 0, 0, *begin, *-outward, self._stack, self._counters)
        if not abs(t - BEFORE) <= OFF:
            # of a thin part the first hit may be its other side, or a wall beside it
            begin = contact + OFF * outward
            t = cast_ray(*self._bvh, 0, 0, *begin, *-outward, self._stack, self._counters)
            if not t <= 2.0 * OFF:
                return False
        near = ((self._centres - (begin - t * outward)) ** 2).sum(axis=1) < PATCH**2
        facing = self._oriented[near] @ outward
        side = np.abs(facing) > ASIDE * self._size[near]
        # a mesh may be oriented inwards as a whole: the larger part of the patch decides
        signed = facing[side]
        sign = 1.0 if signed.sum() >= 0.0 else -1.0
        kept = self._oriented[near][side][sign * signed > 0.0]
        if not len(kept):
            return bool(t < np.inf)
        total = sign * kept.sum(axis=0)
        return bool(total @ outward >= math.cos(FRICTION_ANGLE) * np.linalg.norm(total))
