"""How well a view and others confirm one another, in any pose of the view.

What one view shows must not be where another sees through: so the outline counts as the surface
does.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import minimize

from igrip.perception.scan.planar_pose import PlanarPose, turned_about, wrapped
from igrip.perception.scan.scan_view import ScanView
from igrip.rgbd import Array

POINTS = 350  # of each view
TRY_TURN, TRY_SHIFT = np.radians(3.0), 0.002  # about a pose, to improve it [rad, m]
TRIES = 60
UNLIKELY = 0.1  # by which a yaw of 30° beside the expected one must be better; docs/scan.md
MOST_UNLIKELY = 25.0  # degrees beside it, from which on all are as unlikely


class MutualScore:
    """Compares a view with others, which stay where they are.

    Parameters
    ----------
    view : ScanView
        Its pose is not used.
    others : sequence of ScanView
        In their poses.
    expected : float or None
        Yaw that is likelier than others [rad]. What is round looks alike from all sides, and the
        camera's errors are alike too: so views agree best that were never turned.
    """

    def __init__(
        self, view: ScanView, others: Sequence[ScanView], expected: float | None = None
    ) -> None:
        self._view, self._others, self._expected = view, others, expected
        self._own = _some(view.points)
        self._theirs = [_some(other.in_object[0]) for other in others]

    def of(self, pose: PlanarPose) -> float:
        """Return how well they confirm one another if the view is in a pose, at most 1."""
        confirmed = denied = total = 0.0
        for other, theirs in zip(self._others, self._theirs, strict=True):
            own = other.pose.to_table(pose.apply(self._own))
            for points, seen_by in ((own, other), (pose.to_table(theirs), self._view)):
                yes, no, known = _compared(points, seen_by)
                confirmed, denied, total = confirmed + yes, denied + no, total + known
        return (confirmed - denied) / max(total, 1.0)

    def likelihood(self, pose: PlanarPose) -> float:
        """Return the same, less a little for a yaw that is not the expected one."""
        if self._expected is None:
            return self.of(pose)
        off = float(np.degrees(abs(wrapped(pose.yaw - self._expected))))
        return self.of(pose) - UNLIKELY * min(off, MOST_UNLIKELY) / 30.0

    def improved(self, pose: PlanarPose, centre: Array) -> PlanarPose:
        """Return a pose near to one that is likeliest (Nelder & Mead 1965).

        ``centre`` is the middle of the object, (2,) [m].
        """
        steps = np.array([TRY_TURN, TRY_SHIFT, TRY_SHIFT])

        def moved(x: Array) -> PlanarPose:
            turn, *shift = (float(value) for value in x * steps)
            return turned_about(pose, turn, centre).moved(0.0, *shift)

        def unlikelihood(x: Array) -> float:
            return -self.likelihood(moved(x))

        simplex = np.vstack([np.zeros(3), np.eye(3)]) - 0.25
        how: Any = {"initial_simplex": simplex, "maxfev": TRIES, "xatol": 0.02, "fatol": 1e-5}
        best = minimize(unlikelihood, np.zeros(3), method="Nelder-Mead", options=how)
        return moved(best.x) if -best.fun > self.likelihood(pose) else pose


def _compared(table: Array, other: ScanView) -> tuple[float, float, float]:
    """Return how many points of its table (n, 3) a view confirms and denies, and of how many.

    A point is denied that the view sees through; one that something hides is neither.
    """
    view = other.sighting.view
    camera = table @ view.camera_from_table[:3, :3].T + view.camera_from_table[:3, 3]
    pixels = np.round(view.intrinsics.pixels(camera)).astype(np.int64)
    height, width = other.nearest.shape
    inside = ((pixels >= 0) & (pixels < (width, height))).all(axis=1)
    u, v = pixels[inside].T
    z = camera[inside, 2]
    limit = view.tolerance + 3.0 * view.noise * z**2
    measured, nearest = view.depth[v, u], other.nearest[v, u]
    gap = np.abs(measured - z) / limit
    confirmed = np.where(measured > 0.0, np.clip(1.0 - gap**2, 0.0, None), 0.0)
    # beside an edge it may be the thing's own
    through = np.where(nearest > 0.0, np.clip((nearest - z) / limit - 1.0, 0.0, 1.0), 0.0)
    known = (measured > 0.0) & ((gap < 1.0) | (measured > z))
    return float(confirmed.sum()), float(through.sum()), float(known.sum())


def _some(points: Array) -> Array:
    return points[:: max(1, len(points) // POINTS)]
