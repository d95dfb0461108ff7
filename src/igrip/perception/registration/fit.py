"""Fit one shape in one view: from every start on a cluster, or from where it was."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from igrip.perception.registration.align import align
from igrip.perception.registration.clusters import Cluster
from igrip.perception.registration.initial_poses import try_starts
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.signed_distance import look_up_all
from igrip.perception.registration.view import View
from igrip.perception.registration.visibility import (
    FIT,
    HIDDEN,
    MATCH,
    MISSING,
    OUTSIDE,
    THROUGH,
    explained,
    judge,
)

Array = NDArray[np.float64]

TURNS = np.arange(12) * (2.0 * np.pi / 12)
FEW, MANY = 120, 400  # points of a cluster used to choose among starts, and to fit
TOO_HIGH, TOO_LOW = 0.03, 0.06  # the top of a cluster over and under that of the shape [m]; guess
BEST = 3  # starts that are fitted to the end
NO_UP = np.zeros(3)
ENOUGH = 0.35  # with a lesser share in sight the score falls; guess
HOLD = 0.03  # resting has the weight of so large a share of the points: meshes err, too; guess
ALIKE = 30.0  # points whose errors are one error, as stereo's are alike over a few pixels; guess
FLOOR = 0.002  # what meshes and calibration are wrong by [m]; guess


@dataclass(frozen=True, eq=False)
class Fit:
    """A shape in a pose, and what speaks for it.

    Attributes
    ----------
    shape : Shape
    rotation : (3, 3), translation : (3,)
        Table-from-mesh.
    evidence : (6,)
        See :func:`igrip.perception.registration.visibility.judge`.
    cover : float
        Share of the cluster's points that is explained, by how well.
    up : (3,), height : float
        How it rests on the table: see :func:`igrip.perception.registration.align.align`.
    std : float
        Standard deviation of its position [m].
    """

    shape: Shape
    rotation: Array
    translation: Array
    evidence: Array
    cover: float
    up: Array
    height: float
    std: float = 0.0

    @property
    def visible(self) -> float:
        """Share of the side that faces the camera that was seen where it should be."""
        return float(self.evidence[MATCH])

    @property
    def hidden(self) -> float:
        """Share of it that something nearer hides, or the edge of the picture."""
        return float(self.evidence[HIDDEN] + self.evidence[OUTSIDE])

    @property
    def agreement(self) -> float:
        """How well what should be seen was seen, 0 to 1; what is hidden does not count."""
        seen = self.evidence[MATCH] + self.evidence[THROUGH] + 0.5 * self.evidence[MISSING]
        return float(self.evidence[FIT] / max(seen, 1e-9))

    @property
    def score(self) -> float:
        """How well mesh and measurement explain one another, 0 to 1."""
        return self.agreement * self.cover * min(1.0, self.visible / ENOUGH)


def fit_cluster(
    shape: Shape, cluster: Cluster, view: View, random: np.random.Generator
) -> list[Fit]:
    """Fit a shape that rests on the table to a cluster; the best first.

    Ways of resting that are higher or lower than the cluster are left out.
    """
    resting = shape.resting
    tops = resting.heights + np.array([(shape.samples @ R[2]).max() for R in resting.rotations])
    some = np.flatnonzero((cluster.top < tops + TOO_HIGH) & (cluster.top > tops - TOO_LOW))
    if not len(some):
        return []
    few = _some(len(cluster.points), FEW, random)
    rotations, heights = resting.rotations[some], resting.heights[some]
    shape_of_starts = (len(some), len(TURNS))
    found_rotations = np.empty((*shape_of_starts, 3, 3))
    translations = np.empty((*shape_of_starts, 3))
    evidence, cover = np.empty((*shape_of_starts, 6)), np.empty(shape_of_starts)
    try_starts(
        cluster.points[few], cluster.depths[few], rotations, heights, TURNS,
        shape.samples[::2].copy(), shape.normals[::2].copy(), *shape.field,
        shape.middle, shape.radius, view.depth, view.mask, view.pinhole, view.camera_from_table,
        2.0 * view.base, view.spread, 6, found_rotations, translations, evidence, cover,
    )  # fmt: skip
    fits = []
    for way, turn in np.ndindex(shape_of_starts):
        at, up = (way, turn), rotations[way, 2]
        fit = Fit(
            shape, found_rotations[at], translations[at], evidence[at], float(cover[at]), up,
            float(heights[way] + up @ shape.middle),
        )  # fmt: skip
        fits.append(fit)
    fits.sort(key=lambda fit: -fit.score)
    many = _some(len(cluster.points), MANY, random)
    best = [
        refit(fit, cluster.points[many], cluster.depths[many], view, 0.02, 10)
        for fit in _different(fits)
    ]
    return sorted(best, key=lambda fit: -fit.score)


def refit(fit: Fit, points: Array, depths: Array, view: View, widest: float, steps: int) -> Fit:
    """Move a fit until it lies on points (n, 3) in the frame of the table, and judge it anew."""
    shape = fit.shape
    rotation, translation = fit.rotation.copy(), fit.translation.copy()
    information = np.zeros((6, 6))
    typical = float(np.median(depths)) if len(depths) else 1.0
    narrowest = min(widest, view.base + 2.5 * view.spread * typical**2)
    hold = HOLD if fit.up.any() else 0.0
    rms, weight = align(
        points, *shape.field, shape.middle, rotation, translation, 6, hold, fit.up, fit.height,
        shape.radius, widest, narrowest, steps, information,
    )  # fmt: skip
    _, cover = explained(
        points, depths, rotation, translation, *shape.field, view.base, view.spread
    )
    moved = Fit(
        shape, rotation, translation, np.zeros(6), cover, fit.up, fit.height,
        _std(information, rms, weight, shape.radius),
    )  # fmt: skip
    return judged(moved, view)


def settled(fit: Fit, points: Array, depths: Array, view: View) -> Fit:
    """Fit to all points near, as it is and half round about each of its axes; the best of these.

    Boxes and bottles look nearly alike then: a few hundred points do not tell.
    """
    ways = [refit(way, points, depths, view, 0.02, 12) for way in (fit, *_half_turned(fit))]
    misfits = [misfit(way, points, view) for way in ways]
    return ways[int(np.argmin(misfits))]


def _half_turned(fit: Fit) -> list[Fit]:
    """Return a fit turned half round about each axis of the object through its middle."""
    turned = []
    for axis in fit.shape.axes.T:
        half = 2.0 * np.outer(axis, axis) - np.eye(3)
        shift = fit.rotation @ (fit.shape.middle - half @ fit.shape.middle)
        way = replace(
            fit, rotation=fit.rotation @ half, translation=fit.translation + shift,
            up=half @ fit.up,
        )  # fmt: skip
        turned.append(way)
    return turned


def misfit(fit: Fit, points: Array, view: View) -> float:
    """Return the mean squared distance of points from the mesh, in shares of the tolerance.

    Far points count as those at twice the tolerance do.
    """
    camera = view.camera_from_table
    depths = points @ camera[2, :3] + camera[2, 3]
    limits = 2.0 * (view.base + 2.5 * view.spread * depths**2)
    local = (points - fit.translation) @ fit.rotation
    distances = np.empty(len(points))
    look_up_all(*fit.shape.field, np.ascontiguousarray(local), distances)
    return float(np.minimum((distances / limits) ** 2, 1.0).mean())


def judged(fit: Fit, view: View) -> Fit:
    """Return the same pose with the evidence of this view."""
    shape = fit.shape
    camera = view.camera_from_table
    evidence = np.empty(6)
    judge(
        view.depth, view.mask, view.pinhole, camera[:3, :3] @ fit.rotation,
        camera[:3, :3] @ fit.translation + camera[:3, 3], shape.samples, shape.normals,
        *shape.field, shape.radius, view.base, view.spread, evidence,
    )  # fmt: skip
    return Fit(
        shape, fit.rotation, fit.translation, evidence, fit.cover, fit.up, fit.height, fit.std
    )


def _std(information: Array, rms: float, weight: float, radius: float) -> float:
    """Return the standard deviation of the position [m], from the curvature of the fit."""
    if not np.isfinite(rms):
        return FLOOR
    damped = information / ALIKE + 1e-3 * np.diag([1.0] * 3 + [radius**2] * 3) * weight / ALIKE
    covariance = rms**2 * np.linalg.inv(damped + 1e-12 * np.eye(6))
    return float(np.sqrt(FLOOR**2 + np.trace(covariance[:3, :3]) / 3.0))


def _different(fits: list[Fit]) -> list[Fit]:
    """Return the best few that are not one pose."""
    kept: list[Fit] = []
    for fit in fits:
        if len(kept) == BEST:
            break
        for other in kept:
            shift = fit.rotation @ fit.shape.middle + fit.translation
            shift = shift - (other.rotation @ fit.shape.middle + other.translation)
            turned = np.trace(fit.rotation.T @ other.rotation)  # 1 + 2 cos of the angle
            if np.linalg.norm(shift) < 0.01 and turned > 1.0 + 2.0 * np.cos(np.radians(15.0)):
                break
        else:
            kept.append(fit)
    return kept


def _some(count: int, most: int, random: np.random.Generator) -> NDArray[np.int64]:
    if count <= most:
        return np.arange(count)
    return np.sort(random.choice(count, size=most, replace=False))
