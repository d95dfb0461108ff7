"""Objects that touch: one group of points, several meshes that explain it together."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from igrip.perception.registration.clusters import LEAST, Cluster
from igrip.perception.registration.fit import Fit, fit_cluster, refit
from igrip.perception.registration.shape import Shape
from igrip.perception.registration.signed_distance import look_up_all
from igrip.perception.registration.view import View

Array = NDArray[np.float64]

PARTS = (2, 3)  # into so many parts a group is divided for a start
ON, BESIDE = 0.008, 0.02  # so near is on a mesh; so near is what it is fitted to [m]
TOGETHER = 0.8  # share of the group that the meshes must explain together; guess
OWN = 0.7  # share of what a mesh explains that no other one has explained before; guess


def part(
    group: Cluster,
    wanted: Mapping[str, Shape],
    view: View,
    threshold: float,
    weigh: Callable[[Fit], float],
    random: np.random.Generator,
) -> dict[str, Fit]:
    """Explain a group by two objects or more; nothing, if they leave much of it unexplained.

    The parameters are those of ``search.search``. A single object is
    never found so: a part of something unknown often looks like something known.
    """
    shapes = {shape.name: shape for shape in wanted.values()}
    candidates: list[tuple[float, Fit, NDArray[np.bool_]]] = []
    for number in PARTS:
        labels = _divided(group.points, number)
        for label in range(number):
            own = labels == label
            if own.sum() < LEAST:
                continue
            top = float(np.percentile(group.points[own, 2], 97.0))
            some = Cluster(group.points[own], group.depths[own], top)
            for shape in shapes.values():
                for rough in fit_cluster(shape, some, view, random)[:1]:
                    candidates.append(_candidate(rough, group, view, weigh))
    candidates.sort(key=lambda candidate: -candidate[0])
    left = dict(wanted)
    found: dict[str, Fit] = {}
    explained = np.zeros(len(group.points), dtype=np.bool_)
    for score, fit, on in candidates:
        ids = [id for id, shape in left.items() if shape.name == fit.shape.name]
        if score < threshold or not ids:
            continue
        if (on & ~explained).sum() < OWN * max(on.sum(), 1):
            continue
        found[ids[0]] = fit
        del left[ids[0]]
        explained |= on
    return found if len(found) > 1 and explained.mean() >= TOGETHER else {}


def _candidate(
    rough: Fit, group: Cluster, view: View, weigh: Callable[[Fit], float]
) -> tuple[float, Fit, NDArray[np.bool_]]:
    """Return score, fit and which points of the group are on it, after a fit to all near it."""
    near = np.abs(_distances(rough, group.points)) < BESIDE
    fit = refit(rough, group.points[near], group.depths[near], view, BESIDE, 10)
    away = np.abs(_distances(fit, group.points))
    # of what is near it, refit says how much it explains: for the cover of a cluster
    return weigh(fit), fit, away < ON


def _divided(points: Array, number: int) -> NDArray[np.int64]:
    """Return which part each point belongs to (k-means; Lloyd 1982), from starts far apart."""
    flat = points[:, :2]
    middles = flat[[int(np.argmax(((flat - flat.mean(axis=0)) ** 2).sum(axis=1)))]]
    for _ in range(number - 1):
        away = ((flat[:, None] - middles) ** 2).sum(axis=2).min(axis=1)
        middles = np.concatenate([middles, flat[[int(np.argmax(away))]]])
    labels = np.zeros(len(points), dtype=np.int64)
    for _ in range(10):
        labels = ((flat[:, None] - middles) ** 2).sum(axis=2).argmin(axis=1)
        middles = np.array([
            flat[labels == k].mean(axis=0) if (labels == k).any() else middles[k]
            for k in range(number)
        ])  # fmt: skip
    return labels


def _distances(fit: Fit, points: Array) -> Array:
    local = np.ascontiguousarray((points - fit.translation) @ fit.rotation)
    distances = np.empty(len(points))
    look_up_all(*fit.shape.field, local, distances)
    return distances
