"""Find which models stand where: every shape on every cluster, then one to one.

A search is a generator: it yields what each step was worth, so that it can be done bit by bit
while other things go on (:mod:`igrip.perception.registration.gradual_search`).
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from igrip.perception.registration.clusters import MIN_POINTS, Cluster, clusters_above
from igrip.perception.registration.fit import PoseFit, SearchContext, fit_to_cluster
from igrip.perception.registration.refused import Refusals
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.split_clusters import split_steps
from igrip.rgbd import Array

ON_OBJECT = 0.015  # points so near to a known object are its own [m]
CLUSTERING = 100  # clusters take about as long as so many starts
ROUNDS = 2  # what is left when the first are found is searched again
Steps = Generator[int, None, dict[str, PoseFit]]
"""Yields the number of starts that each step tried; returns what was found, by id."""


@dataclass(eq=False)
class _Fits:
    """The best fit of each shape to each cluster, once it was made."""

    known: dict[tuple[str, int], PoseFit | None] = field(default_factory=dict)
    clusters: list[Cluster] = field(default_factory=list)  # kept, so that their ids stay theirs

    def steps(
        self, shape: Shape, cluster: Cluster, context: SearchContext
    ) -> Generator[int, None, PoseFit | None]:
        """Return the best fit, or None; see :data:`Steps`."""
        key = shape.name, id(cluster)
        if key not in self.known:
            self.clusters.append(cluster)
            best = fit_to_cluster(shape, cluster, context)
            self.known[key] = best[0] if best else None
            yield len(shape.starts) if best else 0
        return self.known[key]


def search_steps(
    points: Array, depths: Array, wanted: Mapping[str, Shape], known: Sequence[PoseFit],
    context: SearchContext, refusals: Refusals | None = None, t: float = 0.0, split: bool = True,
) -> Steps:  # fmt: skip
    """Find objects that rest on the table, step by step.

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
    refusals : Refusals, optional
        Clusters that were searched in vain, at earlier times than ``t`` [s]: they are left out for
        a while, and those that are searched in vain now are put into it.
    split : bool
        Whether clusters are divided in the end that no single object explains; if not, and
        something was found, nothing is put into ``refusals``.
    """
    found: dict[str, PoseFit] = {}
    fits = _Fits()
    refusals = refusals or Refusals()
    every = clusters_above(points, depths, context.view.noise)
    clusters = [rest for one in every if (rest := _without(one, known)) is not None]
    yield CLUSTERING
    searched = [(one, refusals.allowed(one, wanted, t)) for one in clusters]
    searched = [(one, names) for one, names in searched if names]
    for _ in range(ROUNDS):
        left = {id: shape for id, shape in wanted.items() if id not in found}
        if not left or not searched:
            break
        new = yield from _assigned(searched, left, context, fits)
        found.update(new)
        if not new:
            break
        searched = [
            (rest, names) for one, names in searched
            if (rest := _without(one, list(new.values()))) is not None
        ]  # fmt: skip
    if found and not split:
        return found
    for cluster, names in searched:
        left = {id: wanted[id] for id in names if id not in found}
        if len(left) < 2:
            continue
        new = yield from split_steps(cluster, left, context)
        found.update(new)
    for cluster, names in searched:
        if _without(cluster, list(found.values())) is cluster:
            refusals.add(cluster, [id for id in names if id not in found], t)
    return found


def _without(cluster: Cluster, fits: Sequence[PoseFit]) -> Cluster | None:
    """Return a cluster without the points of these objects; None: too few are left."""
    free = np.ones(len(cluster.points), dtype=np.bool_)
    for fit in fits:
        free &= ~on_object(fit, cluster.points)
    if free.all():
        return cluster
    return cluster.part(free) if free.sum() >= max(MIN_POINTS, 0.1 * len(free)) else None


def _assigned(
    searched: Sequence[tuple[Cluster, set[str]]], wanted: Mapping[str, Shape],
    context: SearchContext, made: _Fits,
) -> Steps:  # fmt: skip
    """Give each id at most one cluster, and each cluster one id, for the highest sum of scores."""
    ids = list(wanted)
    fits: dict[tuple[str, int], PoseFit] = {}
    scores = np.zeros((len(ids), len(searched)))
    for column, (cluster, names) in enumerate(searched):
        for row, id in enumerate(ids):
            if id not in names:
                continue
            best = yield from made.steps(wanted[id], cluster, context)
            if best is not None:
                fits[id, column] = best
                scores[row, column] = context.score(best)
    good = np.where(scores >= context.threshold, scores, 0.0)
    rows, columns = linear_sum_assignment(-good)
    return {
        ids[row]: fits[ids[row], int(column)]
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
