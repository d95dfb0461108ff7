"""Where a new view belongs: turns are tried, each is fitted, and views must confirm one another.

Point to plane (Chen & Medioni 1992, Image and Vision Computing 10:145-155), for a thing that
stands on a table: a turn about the vertical and two shifts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from igrip.perception.scan.mutual_score import MutualScore
from igrip.perception.scan.planar_pose import PlanarPose, turned_about, wrapped
from igrip.perception.scan.scan_view import SPACING, ScanView, nearest
from igrip.rgbd import Array

MAX_TURN = np.radians(75.0)  # of a view, from the view before
TURNS = np.radians(np.arange(-60.0, 61.0, 10.0))  # that are tried, from the view before
FIRST_GATE, LAST_GATE, STEPS = 0.02, 0.005, 12  # of a fit [m]
SAME_SIDE = 0.6  # cosine of two normals, at least
BESIDE = 2.0 * SPACING  # so far along the surface the next point is, at most [m]
FEW = 400  # points of a fit
COMPARED = 6  # views that a fit is compared with
MIN_SCORE = 0.6  # below it a view belongs nowhere; guess


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of the object with normals, (n, 3) each [m], to which views are fitted."""

    points: Array
    normals: Array
    tree: cKDTree

    @property
    def centre(self) -> Array:
        """The middle of its footprint, (2,) [m]."""
        flat = self.points[:, :2]
        return np.asarray(0.5 * (flat.min(axis=0) + flat.max(axis=0)))


def cloud_of(views: Sequence[ScanView]) -> Cloud:
    """Return the points of some views."""
    parts = [view.in_object for view in views]
    points = np.concatenate([points for points, _ in parts])
    normals = np.concatenate([normals for _, normals in parts])
    return Cloud(points, normals, cKDTree(points))


@dataclass(frozen=True)
class Registered:
    """A pose, object-from-table, and how well views confirm it, at most 1."""

    pose: PlanarPose
    score: float


def register(
    view: ScanView, views: Sequence[ScanView], expected: float | None, random: np.random.Generator
) -> Registered | None:
    """Return where a view belongs among others, the last of which came just before it.

    Parameters
    ----------
    view : ScanView
        Its pose is not used.
    views : sequence of ScanView
        In their poses.
    expected : float or None
        The likeliest turn since the last of them, where any is likelier than others [rad].
    random : Generator
        Chooses points.

    Returns
    -------
    Registered or None
        None: it belongs nowhere, or there are too few points.
    """
    if len(view.points) < 50:
        return None
    cloud = cloud_of(views)
    last = views[-1]
    yaw = None if expected is None else last.pose.yaw + expected
    mutual = MutualScore(view, [views[k] for k in _some(len(views), COMPARED)], yaw)
    # a hand may have shifted it, too
    moved = last.sighting.points[:, :2].mean(axis=0) - view.sighting.points[:, :2].mean(axis=0)
    shift = last.pose.turn(np.append(moved, 0.0)[None])[0]
    start = last.pose.moved(0.0, float(shift[0]), float(shift[1]))
    few = np.sort(random.permutation(len(view.points))[:FEW])
    found: list[Registered] = []
    for turn in TURNS:
        pose = fit(view, few, cloud, turned_about(start, float(turn), cloud.centre))
        if abs(wrapped(pose.yaw - last.pose.yaw)) < MAX_TURN:
            found.append(Registered(pose, mutual.likelihood(pose)))
    if not found:
        return None
    best = max(found, key=lambda one: one.score)
    pose = mutual.improved(best.pose, cloud.centre)
    score = mutual.of(pose)
    return Registered(pose, score) if score > MIN_SCORE else None


def fit(view: ScanView, few: NDArray[np.int64], cloud: Cloud, pose: PlanarPose) -> PlanarPose:
    """Return a pose, moved until some points of a view lie on a cloud."""
    centre = cloud.centre
    for step in range(STEPS):
        gate = FIRST_GATE * (LAST_GATE / FIRST_GATE) ** (step / (STEPS - 1))
        points, normals = pose.apply(view.points[few]), pose.turn(view.normals[few])
        away, near = nearest(cloud.tree, points, 2.0 * gate)
        found = np.isfinite(away)
        found[found] &= (normals[found] * cloud.normals[near[found]]).sum(axis=1) > SAME_SIDE
        if found.sum() < 20:
            return pose
        n, q = cloud.normals[near[found]], cloud.points[near[found]]
        p = points[found]
        gap = ((p - q) * n).sum(axis=1)
        weight = weights(gap, away[found], gate)
        arm = p[:, :2] - centre
        lever = arm[:, 0] * n[:, 1] - arm[:, 1] * n[:, 0]
        J = np.stack([lever, n[:, 0], n[:, 1]], axis=1)
        A = (J * weight[:, None]).T @ J
        total = float(weight.sum()) + 1e-9
        # what the points leave open stays as it is
        A += 1e-3 * total * np.diag([float((arm**2).mean()), 1.0, 1.0])
        d = np.linalg.solve(A, -(J * (weight * gap)[:, None]).sum(axis=0))
        pose = turned_about(pose, float(np.clip(d[0], -0.2, 0.2)), centre)
        pose = pose.moved(0.0, *(float(v) for v in np.clip(d[1:], -0.01, 0.01)))
    return pose


def weights(gap: Array, away: Array, gate: float) -> Array:
    """Return how much pairs of points count, (n,): Tukey's biweight, and none beyond an edge.

    ``gap`` is their distance along the normal, ``away`` that in space [m].
    """
    beside = away**2 - gap**2 > BESIDE**2  # the cloud ends there
    return np.where(beside, 0.0, np.clip(1.0 - (gap / gate) ** 2, 0.0, None) ** 2)


def _some(count: int, most: int) -> list[int]:
    """Return evenly spread numbers of things, the last two among them."""
    if count <= most:
        return list(range(count))
    spread = np.linspace(0, count - 1, most - 1).round().astype(int).tolist()
    return sorted({*spread, count - 2})
