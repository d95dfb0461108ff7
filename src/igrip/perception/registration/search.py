"""Find which models stand where: every shape on every cluster, then one to one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from igrip.perception.registration.clusters import MIN_POINTS, Cluster, clusters_above
from igrip.perception.registration.fit import PoseFit, SearchContext, fit_to_cluster
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.split_clusters import split_cluster
from igrip.rgbd import Array

ON_OBJECT = 0.015  # points so near to a known object are its own [m]
ROUNDS = 2  # what is left when the first are found is searched again


def find_objects(
    points: Array, depths: Array, wanted: Mapping[str, Shape], known: Sequence[PoseFit],
    context: SearchContext,
) -> dict[str, PoseFit]:  # fmt: skip
    """Find objects that rest on the table; return them by id.

    Parameters
    ----------
    points : (n, 3), depths : (n,)
        In the frame of the table, and along the optical axis [m].
    wanted : mapping of str to Shape
        What is looked for, by id.
    known : sequence of PoseFit
        Objects that are tracked already: their points are left out.
    context : SearchContext
        The frame, and what counts as found.
    """
    found: dict[str, PoseFit] = {}

    def left() -> dict[str, Shape]:
        return {id: shape for id, shape in wanted.items() if id not in found}

    def clusters() -> list[Cluster]:
        every = clusters_above(points, depths, context.view.noise)
        fits = (*known, *found.values())
        return [rest for cluster in every if (rest := _without(cluster, fits)) is not None]

    for _ in range(ROUNDS):
        if not left():
            break
        new = _assign(clusters(), left(), context)
        found.update(new)
        if not new:
            break
    if len(left()) < 2:
        return found
    for cluster in clusters():
        found.update(split_cluster(cluster, left(), context))
    return found


def _without(cluster: Cluster, fits: Sequence[PoseFit]) -> Cluster | None:
    """Return a cluster without the points of these objects; None: too few are left."""
    free = np.ones(len(cluster.points), dtype=np.bool_)
    for fit in fits:
        free &= ~on_object(fit, cluster.points)
    if free.all():
        return cluster
    return cluster.part(free) if free.sum() >= max(MIN_POINTS, 0.1 * len(free)) else None


def _assign(
    clusters: Sequence[Cluster], wanted: Mapping[str, Shape], context: SearchContext
) -> dict[str, PoseFit]:
    """Give each id at most one cluster, and each cluster one id, for the highest sum of scores."""
    ids = list(wanted)
    shapes = {shape.name: shape for shape in wanted.values()}
    fits: dict[tuple[str, int], PoseFit] = {}
    scores = np.zeros((len(ids), len(clusters)))
    for column, cluster in enumerate(clusters):
        for name, shape in shapes.items():
            best = fit_to_cluster(shape, cluster, context)
            if not best:
                continue
            fits[name, column] = best[0]
            for row, id in enumerate(ids):
                if wanted[id].name == name:
                    scores[row, column] = context.score(best[0])
    good = np.where(scores >= context.threshold, scores, 0.0)
    rows, columns = linear_sum_assignment(-good)
    return {
        ids[row]: fits[wanted[ids[row]].name, int(column)]
        for row, column in zip(rows, columns, strict=True)
        if good[row, column] > 0.0
    }


def on_object(fit: PoseFit, points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) of the table are on an object, or inside it."""
    result = np.zeros(len(points), dtype=np.bool_)
    surface = fit.shape.surface
    reach = surface.radius + ON_OBJECT
    near = np.flatnonzero(((points - fit.centre) ** 2).sum(axis=1) < reach**2)
    if len(near):
        values, origin, cell = surface.field
        corner = np.round((fit.pose.to_mesh(points[near]) - origin) / cell).astype(int)
        corner = np.clip(corner, 0, np.array(values.shape) - 1)
        result[near] = values[tuple(corner.T)] < ON_OBJECT
    return result
