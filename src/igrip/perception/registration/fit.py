"""Fit one shape in one view: from every start on a cluster, or from where it was."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from igrip.perception.registration.align import Annealing, Resting, align
from igrip.perception.registration.clusters import Cluster
from igrip.perception.registration.initial_poses import initial_poses
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import (
    Visibility,
    compare_with_depth,
    share_explained,
)
from igrip.rgbd import Array

FEW, MANY = 120, 400  # points of a cluster used to choose among starts, and to fit
TOO_HIGH, TOO_LOW = 0.03, 0.06  # the top of a cluster over and under that of the shape [m]; guess
TOO_WIDE = 0.02  # two thirds of a cluster beyond the width of the shape [m]; guess
MAX_STARTS = 3  # that are fitted to the end
UNLIKELY = 0.3  # if no start has such a score, only the best is fitted to the end; docs/poses.md
MIN_VISIBLE = 0.35  # with a lesser share visible the score falls; guess
REST_WEIGHT = 0.03  # of resting, in shares of the points: meshes err, too; guess
CORRELATED = 30.0  # points whose errors are one error, as stereo's are over a few pixels; guess
MIN_STD = 0.002  # what meshes and calibration are wrong by [m]; guess
SAME_SHIFT, SAME_TURN = 0.01, np.radians(15.0)  # within both two starts are one [m, rad]
SEARCH = Annealing(0.02, 0.0, 10)  # gates and steps of a fit to a cluster
DENSE = Annealing(0.02, 0.0, 12)  # and of one to all points near


@dataclass(frozen=True, eq=False)
class PoseFit:
    """A shape in a pose, and how well the picture agrees."""

    shape: Shape
    pose: RigidPose  # table-from-mesh
    visibility: Visibility  # of the shape in the picture
    cover: float  # share of the cluster's points that is explained, by how well
    resting: Resting  # how it rests on the table
    std: float = 0.0  # of its position [m]

    @property
    def centre(self) -> Array:
        """Where the centre of the mesh is, (3,), in the frame of the table [m]."""
        centre: Array = self.pose.rotation @ self.shape.surface.centre + self.pose.translation
        return centre

    @property
    def hidden(self) -> float:
        """Share of the side that faces the camera that is covered, or out of the picture."""
        return self.visibility.hidden + self.visibility.outside

    @property
    def agreement(self) -> float:
        """How well it agrees where it is not hidden, 0 to 1."""
        share = self.visibility
        return share.fit / max(share.match + share.through + 0.5 * share.missing, 1e-9)

    @property
    def score(self) -> float:
        """How well mesh and measurement explain one another, 0 to 1."""
        return self.agreement * self.cover * min(1.0, self.visibility.match / MIN_VISIBLE)


@dataclass(frozen=True)
class SearchContext:
    """What a search for objects needs besides points and shapes."""

    view: DepthView
    score: Callable[[PoseFit], float]  # 0 to 1
    threshold: float  # fits with a lesser score are none
    random: np.random.Generator  # chooses among points


def fit_to_cluster(shape: Shape, cluster: Cluster, context: SearchContext) -> list[PoseFit]:
    """Fit a shape that rests on the table to a cluster; the best first.

    Ways of resting that are higher or lower than the cluster are left out, and narrower ones.
    """
    view, surface, ways = context.view, shape.surface, shape.stable_poses
    spots = (surface.points - surface.centre) @ ways.rotations.transpose(0, 2, 1)  # (k, n, 3)
    tops = ways.heights + ways.rotations[:, 2] @ surface.centre + spots[..., 2].max(axis=1)
    widths = 2.0 * np.linalg.norm(spots[..., :2], axis=2).max(axis=1)
    right_height = (cluster.top < tops + TOO_HIGH) & (cluster.top > tops - TOO_LOW)
    some = np.flatnonzero(right_height & (cluster.width < widths + TOO_WIDE))
    if not len(some):
        return []
    starts = shape.starts[np.isin(shape.starts[:, 0], some)]
    few = _subset(len(cluster.points), FEW, context.random)
    settled = initial_poses(
        cluster.points[few], cluster.depths[few], ways, starts,
        surface._replace(points=surface.points[::2].copy(), normals=surface.normals[::2].copy()),
        view._replace(tolerance=2.0 * view.tolerance),
    )  # fmt: skip
    fits = []
    for start in settled:
        up = ways.rotations[start.way, 2]
        height = float(ways.heights[start.way] + up @ surface.centre)
        resting = Resting(up, height, REST_WEIGHT)
        fits.append(PoseFit(shape, start.pose, start.visibility, start.cover, resting))
    fits.sort(key=lambda fit: -fit.score)
    many = _subset(len(cluster.points), MANY, context.random)
    best = [
        refit(fit, cluster.points[many], cluster.depths[many], view, SEARCH)
        for fit in (_distinct(fits) if fits[0].score >= UNLIKELY else fits[:1])
    ]
    return sorted(best, key=lambda fit: -fit.score)


def refit(
    fit: PoseFit, points: Array, depths: Array, view: DepthView, annealing: Annealing
) -> PoseFit:
    """Move a fit until it lies on points (n, 3) in the frame of the table, and rate it anew.

    The last gate is never less than what noise allows at ``depths`` (n,).
    """
    surface = fit.shape.surface
    pose = RigidPose(fit.pose.rotation.copy(), fit.pose.translation.copy())
    information = np.zeros((6, 6))
    typical = float(np.median(depths)) if len(depths) else 1.0
    noise = view.tolerance + 2.5 * view.noise * typical**2
    annealing = annealing._replace(last_gate=min(annealing.first_gate, noise))
    rms, weight = align(points, surface, pose, fit.resting, False, annealing, information)
    cover = share_explained(points, depths, pose, surface, view)
    std = _std(information, rms, weight, surface.radius)
    return rated(replace(fit, pose=pose, cover=cover, std=std), view)


def refit_flipped(fit: PoseFit, points: Array, depths: Array, view: DepthView) -> PoseFit:
    """Fit to all points near, as it is and half round about each of its axes; return the best.

    Boxes and bottles look nearly alike then: a few hundred points do not decide.
    """
    fits = [refit(one, points, depths, view, DENSE) for one in (fit, *_flipped(fit))]
    return fits[int(np.argmin([misfit(one, points, view) for one in fits]))]


def _flipped(fit: PoseFit) -> list[PoseFit]:
    """Return a fit turned half round about each axis of the object through its centre."""
    rotation, translation = fit.pose
    centre = fit.shape.surface.centre
    flipped = []
    for axis in fit.shape.axes.T:
        half = 2.0 * np.outer(axis, axis) - np.eye(3)
        pose = RigidPose(rotation @ half, translation + rotation @ (centre - half @ centre))
        resting = fit.resting._replace(up=half @ fit.resting.up)
        flipped.append(replace(fit, pose=pose, resting=resting))
    return flipped


def misfit(fit: PoseFit, points: Array, view: DepthView) -> float:
    """Return the mean squared distance of points from the mesh, in shares of the tolerance.

    Far points count as those at twice the tolerance do.
    """
    camera = view.camera_from_table
    depths = points @ camera[2, :3] + camera[2, 3]
    limits = 2.0 * (view.tolerance + 2.5 * view.noise * depths**2)
    distances = fit.shape.surface.field.distances(fit.pose.to_mesh(points))
    return float(np.minimum((distances / limits) ** 2, 1.0).mean())


def rated(fit: PoseFit, view: DepthView) -> PoseFit:
    """Return the same pose with its visibility in this view."""
    pose = fit.pose.after(view.camera_from_table)
    return replace(fit, visibility=compare_with_depth(view, pose, fit.shape.surface))


def _std(information: Array, rms: float, weight: float, radius: float) -> float:
    """Return the standard deviation of the position [m], from the curvature of the fit."""
    if not np.isfinite(rms):
        return MIN_STD
    damping = 1e-3 * np.diag([1.0] * 3 + [radius**2] * 3) * weight / CORRELATED
    covariance = rms**2 * np.linalg.inv(information / CORRELATED + damping + 1e-12 * np.eye(6))
    return float(np.sqrt(MIN_STD**2 + np.trace(covariance[:3, :3]) / 3.0))


def _distinct(fits: list[PoseFit]) -> list[PoseFit]:
    """Return the best few that are not one pose."""
    kept: list[PoseFit] = []
    for fit in fits:
        if len(kept) == MAX_STARTS:
            break
        for other in kept:
            turned = np.trace(fit.pose.rotation.T @ other.pose.rotation)  # 1 + 2 cos of the angle
            near = np.linalg.norm(fit.centre - other.centre) < SAME_SHIFT
            if near and turned > 1.0 + 2.0 * np.cos(SAME_TURN):
                break
        else:
            kept.append(fit)
    return kept


def _subset(count: int, size: int, random: np.random.Generator) -> NDArray[np.int64]:
    if count <= size:
        return np.arange(count)
    return np.sort(random.choice(count, size=size, replace=False))
