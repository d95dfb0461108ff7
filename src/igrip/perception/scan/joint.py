"""All views at once: their poses are moved together until they agree, so that the turn closes.

Simultaneous registration of many views, in a plane (Neugebauer 1997; Pulli 1999).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from igrip.perception.scan.mutual_score import MutualScore
from igrip.perception.scan.planar_pose import wrapped
from igrip.perception.scan.register import SAME_SIDE, weights
from igrip.perception.scan.scan_view import ScanView, nearest
from igrip.rgbd import Array

FAR = np.radians(100.0)  # views that are turned by more share too little
GATES = tuple(np.geomspace(0.012, 0.004, 10))  # of each round [m]
POINTS = 300  # of a view, in each pair
BESIDE = 8  # views that one is compared with
HOLD = 0.05  # of a view where it is, and of its yaw where it was, in shares of its points


def joined(
    views: Sequence[ScanView], random: np.random.Generator, gates: Sequence[float] = GATES
) -> list[ScanView]:
    """Return the views in poses that agree best; the first stays where it is.

    There is a round for each of ``gates``: points farther from one another are no pair [m].
    """
    views = list(views)
    if len(views) < 2:
        return views
    for gate in gates:
        views = _round(views, float(gate), random)
    return views


def polished(views: Sequence[ScanView], centre: Array) -> list[ScanView]:
    """Return the views, each moved once more so that it and those beside it confirm one another.

    ``centre`` is the middle of the object, (2,) [m].
    """
    views = list(views)
    for k, view in enumerate(views):
        others = sorted(
            (one for one in views if one is not view),
            key=lambda one: abs(wrapped(one.pose.yaw - view.pose.yaw)),
        )[:BESIDE]  # fmt: skip
        views[k] = view.placed(MutualScore(view, others, view.pose.yaw).improved(view.pose, centre))
    return views


def _round(views: list[ScanView], gate: float, random: np.random.Generator) -> list[ScanView]:
    """Return the views after one step of Gauss-Newton."""
    placed = [view.in_object for view in views]
    trees = [cKDTree(points) for points, _ in placed]
    n = 3 * len(views)
    A, b = np.zeros((n, n)), np.zeros(n)
    spread = float(np.mean([np.ptp(points[:, :2]) for points, _ in placed])) / 4.0
    for i, view in enumerate(views):
        points, normals = placed[i]
        few = np.sort(random.permutation(len(points))[:POINTS])
        points, normals = points[few], normals[few]
        for j, other in enumerate(views):
            if i == j or abs(wrapped(view.pose.yaw - other.pose.yaw)) > FAR:
                continue
            away, near = nearest(trees[j], points, 2.0 * gate)
            found = np.isfinite(away)
            q, m = placed[j][0][near[found]], placed[j][1][near[found]]
            p = points[found]
            gap = ((p - q) * m).sum(axis=1)
            same = (normals[found] * m).sum(axis=1) > SAME_SIDE
            weight = np.where(same, weights(gap, away[found], gate), 0.0)
            one, two = _derivatives(p, m), -_derivatives(q, m)
            _add(A, b, (i, j), (one, two), gap, weight)
    hold = HOLD * np.diag(A).reshape(-1, 3)[:, 1:].mean() + 1e-9
    A[np.diag_indices(n)] += hold * np.tile([spread**2, 1.0, 1.0], len(views))
    # what is round would slip back, turn by turn
    b[::3] += hold * spread**2 * np.array([view.pose.yaw - view.registered for view in views])
    A[:3], A[:, :3], b[:3] = 0.0, 0.0, 0.0  # the first stays
    A[:3, :3] = np.eye(3)
    d = np.linalg.solve(A, -b).reshape(-1, 3)
    d = np.clip(d, [-0.1, -0.01, -0.01], [0.1, 0.01, 0.01])
    return [
        view.placed(view.pose.moved(*(float(value) for value in step)))
        for view, step in zip(views, d, strict=True)
    ]


def _derivatives(points: Array, normals: Array) -> Array:
    """Return how the gaps change as points turn about the origin and shift, (n, 3)."""
    lever = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    return np.stack([lever, normals[:, 0], normals[:, 1]], axis=1)


def _add(
    A: Array, b: Array, pair: tuple[int, int], derivatives: tuple[Array, Array], gap: Array,
    weight: Array,
) -> None:  # fmt: skip
    """Add the normal equations of one pair of views."""
    for k, J in zip(pair, derivatives, strict=True):
        rows = slice(3 * k, 3 * k + 3)
        b[rows] += (J * (weight * gap)[:, None]).sum(axis=0)
        for other, K in zip(pair, derivatives, strict=True):
            A[rows, 3 * other : 3 * other + 3] += (J * weight[:, None]).T @ K
