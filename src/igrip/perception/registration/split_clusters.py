"""Objects that touch: one cluster, several meshes that explain it together."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

from igrip.perception.registration.align import Annealing
from igrip.perception.registration.clusters import MIN_POINTS, Cluster
from igrip.perception.registration.fit import PoseFit, SearchContext, fit_to_cluster, refit
from igrip.perception.registration.shape import Shape
from igrip.rgbd import Array

PARTS = (2, 3)  # into so many parts a cluster is divided for a start
ON, BESIDE = 0.008, 0.02  # so near is on a mesh; so near is what it is fitted to [m]
ANNEALING = Annealing(BESIDE, 0.0, 10)
MIN_EXPLAINED = 0.8  # share of the cluster that the meshes must explain together; guess
MIN_OWN = 0.7  # share of what a mesh explains that no other has explained before; guess


class _Candidate(NamedTuple):
    """A fit, its score, and which points of the cluster are on it, (n,)."""

    score: float
    fit: PoseFit
    on: NDArray[np.bool_]


def split_steps(
    cluster: Cluster, wanted: Mapping[str, Shape], context: SearchContext
) -> Generator[int, None, dict[str, PoseFit]]:
    """Explain a cluster by two objects or more; by none, if they leave much of it unexplained.

    A single object is never found so: a part of something unknown often looks like something
    known. For the parameters see :func:`igrip.perception.registration.search.search_steps`.
    """
    shapes = {shape.name: shape for shape in wanted.values()}
    candidates: list[_Candidate] = []
    for count in PARTS:
        labels = _divide(cluster.points, count)
        for label in range(count):
            own = labels == label
            if own.sum() < MIN_POINTS:
                continue
            part = cluster.part(own)
            for shape in shapes.values():
                best = fit_to_cluster(shape, part, context)[:1]
                candidates += [_candidate(fit, cluster, context) for fit in best]
                yield len(shape.starts) if best else 0
    candidates.sort(key=lambda candidate: -candidate.score)
    left = dict(wanted)
    found: dict[str, PoseFit] = {}
    explained = np.zeros(len(cluster.points), dtype=np.bool_)
    for score, fit, on in candidates:
        ids = [id for id, shape in left.items() if shape.name == fit.shape.name]
        if score < context.threshold or not ids:
            continue
        if (on & ~explained).sum() < MIN_OWN * max(on.sum(), 1):
            continue
        found[ids[0]] = fit
        del left[ids[0]]
        explained |= on
    return found if len(found) > 1 and explained.mean() >= MIN_EXPLAINED else {}


def _candidate(rough: PoseFit, cluster: Cluster, context: SearchContext) -> _Candidate:
    """Fit to all points of the cluster that are near."""
    near = np.abs(_distances(rough, cluster.points)) < BESIDE
    # the cover is of what is near it, not of the whole cluster
    fit = refit(rough, cluster.points[near], cluster.depths[near], context.view, ANNEALING)
    return _Candidate(context.score(fit), fit, np.abs(_distances(fit, cluster.points)) < ON)


def _divide(points: Array, number: int) -> NDArray[np.int64]:
    """Return which part each point belongs to (k-means; Lloyd 1982), from starts far apart."""
    flat = points[:, :2]
    middles = flat[[int(np.argmax(((flat - flat.mean(axis=0)) ** 2).sum(axis=1)))]]
    for _ in range(number - 1):
        away = ((flat[:, None] - middles) ** 2).sum(axis=2).min(axis=1)
        middles = np.concatenate([middles, flat[[int(np.argmax(away))]]])
    return kmeans2(flat, middles, iter=10, minit="matrix")[1].astype(np.int64)


def _distances(fit: PoseFit, points: Array) -> Array:
    return fit.shape.surface.field.distances(fit.pose.to_mesh(points))
