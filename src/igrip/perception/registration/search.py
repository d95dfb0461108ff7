"""Find which models stand where: every shape on every cluster, then one to one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from igrip.perception.registration.clusters import LEAST, Cluster, clusters_above
from igrip.perception.registration.fit import Fit, fit_cluster
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.split_clusters import part
from igrip.perception.registration.view import View

Array = NDArray[np.float64]

TAKEN = 0.015  # points so near to an object that was found are its own [m]
ROUNDS = 2  # what is left when the first are found is looked at again


def search(
    points: Array,
    depths: Array,
    wanted: Mapping[str, Shape],
    taken: Sequence[Fit],
    view: View,
    threshold: float,
    weigh: Callable[[Fit], float],
    random: np.random.Generator,
) -> dict[str, Fit]:
    """Find objects that rest on the table.

    Parameters
    ----------
    points : (n, 3), depths : (n,)
        In the frame of the table, and along the optical axis [m].
    wanted : mapping of str to Shape
        What is looked for, by id.
    taken : sequence of Fit
        Objects that are known already: their points are left out.
    view : View
        The frame.
    threshold : float
        Fits with a lesser score are nothing.
    weigh : callable
        Score of a fit, 0 to 1.
    random : numpy.random.Generator
        Chooses among points.

    Returns
    -------
    dict of str to Fit
        What was found, by id.
    """
    found: dict[str, Fit] = {}
    for _ in range(ROUNDS):
        left = {id: shape for id, shape in wanted.items() if id not in found}
        if not left:
            break
        groups = _groups(points, depths, (*taken, *found.values()), view)
        new = _assign(groups, left, view, threshold, weigh, random)
        found.update(new)
        if not new:
            break
    left = {id: shape for id, shape in wanted.items() if id not in found}
    if len(left) < 2:
        return found
    for group in _groups(points, depths, (*taken, *found.values()), view):
        new = part(group, left, view, threshold, weigh, random)
        found.update(new)
        left = {id: shape for id, shape in left.items() if id not in new}
    return found


def _groups(points: Array, depths: Array, known: Sequence[Fit], view: View) -> list[Cluster]:
    """Return what stands on the table without the points of known objects."""
    return [
        rest
        for group in clusters_above(points, depths, view.spread)
        for rest in _without(group, known)
    ]


def _without(group: Cluster, fits: Sequence[Fit]) -> list[Cluster]:
    """Return a cluster without the points of these objects, if enough are left."""
    free = np.ones(len(group.points), dtype=np.bool_)
    for fit in fits:
        free &= ~on_shape(fit, group.points)
    if free.all():
        return [group]
    if free.sum() < max(LEAST, 0.1 * len(free)):
        return []
    top = float(np.percentile(group.points[free, 2], 97.0))
    return [Cluster(group.points[free], group.depths[free], top)]


def _assign(
    groups: Sequence[Cluster],
    wanted: Mapping[str, Shape],
    view: View,
    threshold: float,
    weigh: Callable[[Fit], float],
    random: np.random.Generator,
) -> dict[str, Fit]:
    """Give each id at most one cluster, and each cluster one id, for the highest sum of scores."""
    ids = list(wanted)
    shapes = {shape.name: shape for shape in wanted.values()}
    fits: dict[tuple[str, int], Fit] = {}
    scores = np.zeros((len(ids), len(groups)))
    for column, group in enumerate(groups):
        for name, shape in shapes.items():
            best = fit_cluster(shape, group, view, random)
            if not best:
                continue
            fits[name, column] = best[0]
            for row, id in enumerate(ids):
                if wanted[id].name == name:
                    scores[row, column] = weigh(best[0])
    good = np.where(scores >= threshold, scores, 0.0)
    rows, columns = linear_sum_assignment(-good)
    return {
        ids[row]: fits[wanted[ids[row]].name, int(column)]
        for row, column in zip(rows, columns, strict=True)
        if good[row, column] > 0.0
    }


def on_shape(fit: Fit, points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) of the table are on a shape, or inside it."""
    result = np.zeros(len(points), dtype=np.bool_)
    shape = fit.shape
    middle = fit.rotation @ shape.middle + fit.translation
    near = np.flatnonzero(((points - middle) ** 2).sum(axis=1) < (shape.radius + TAKEN) ** 2)
    if len(near):
        local = (points[near] - fit.translation) @ fit.rotation
        values, origin, cell = shape.field
        corner = np.clip(
            np.round((local - origin) / cell).astype(int), 0, np.array(values.shape) - 1
        )
        result[near] = values[tuple(corner.T)] < TAKEN
    return result
