"""Which simple shape explains a segment best: each is drawn into the depth picture and compared.

What would be seen through counts against a shape, and so does what it leaves unexplained: the
outline is fitted together with the surface. What something nearer covers counts for nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from igrip.compiled import kernel
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import local_depths
from igrip.perception.shapes.primitives import PRIMITIVES, Primitive, Rays
from igrip.perception.shapes.segments import STRIDE, Segment
from igrip.rgbd import Array

SAMPLES = 500  # pixels that are compared
AROUND = 0.35  # of a segment's size is looked at beside it
HOLLOW = 0.7  # weight of what is measured behind a shape within the thing's outline: it is open
FIRST_EVALUATIONS, EVALUATIONS = 80, 240  # of each shape, and of the finalists
FINALISTS, NOT_FAR = 3, 0.15  # so many go on, unless they are so much worse
WRONG_AT = 3.0  # times the tolerance at which a pixel counts as wholly wrong


class Evidence(NamedTuple):
    """Pixels in and about a segment."""

    rays: Rays
    depths: Array  # (m,), measured along the optical axis [m]; 0: not
    own: NDArray[np.bool_]  # (m,), of the segment
    weights: Array  # (m,), 0 where a hand is in front
    limits: Array  # (m,), within which a measurement fits [m]


class ShapeFit(NamedTuple):
    """A simple shape in the frame of the table."""

    kind: str
    primitive: Primitive
    parameters: Array
    misfit: float  # 0: every pixel is explained; 1: none
    std: float  # of its middle [m]


def evidence_of(segment: Segment, depth: NDArray[np.float32], view: DepthView) -> Evidence:
    """Return some hundred pixels in and about a segment; ``depth`` (h, w) is averaged [m]."""
    height, width = depth.shape
    low, high = segment.pixels.min(axis=0), segment.pixels.max(axis=0)
    margin = np.maximum(8, AROUND * (high - low)).astype(int)
    low, high = np.maximum(low - margin, 0), np.minimum(high + margin, (width - 1, height - 1))
    area = float(np.prod(high - low + 1))
    stride = STRIDE * max(1, round(float(np.sqrt(area / SAMPLES)) / STRIDE))
    low -= low % STRIDE  # the grid is that of the segment's pixels
    grid = np.meshgrid(
        np.arange(low[0], high[0] + 1, stride), np.arange(low[1], high[1] + 1, stride)
    )
    u, v = (coordinate.ravel() for coordinate in grid)
    window = np.ascontiguousarray(depth[low[1] : high[1] + 1, low[0] : high[0] + 1])
    smooth = np.empty(tuple(-(-n // STRIDE) for n in window.shape))
    local_depths(window, STRIDE, 0.05, 10.0, smooth)
    rows, columns = (v - low[1]) // STRIDE, (u - low[0]) // STRIDE
    measured = smooth[rows, columns]
    mine = np.zeros(smooth.shape, dtype=np.bool_)
    own = (segment.pixels - low) // STRIDE
    mine[own[:, 1], own[:, 0]] = True
    pixels = np.stack([u, v], axis=1).astype(np.float64)
    ahead = view.intrinsics.points(pixels, np.ones(len(u)))
    rays = Rays(view.table_from_camera[:3, 3], ahead @ view.table_from_camera[:3, :3].T)
    typical = np.where(measured > 0.0, measured, np.median(measured[measured > 0.0]))
    return Evidence(
        rays, measured, mine[rows, columns], (view.mask[v, u] == 0).astype(np.float64),
        view.tolerance + 2.5 * view.noise * typical**2,
    )  # fmt: skip


def misfit(primitive: Primitive, parameters: Array, evidence: Evidence) -> float:
    """Return how much of the evidence contradicts a shape, in shares of the segment."""
    return float(_contradiction(primitive.depths(parameters, evidence.rays), *evidence[1:]))


@kernel
def _contradiction(predicted, depths, own, weights, limits):
    wrong, total = 0.0, 0.0
    for n in range(predicted.shape[0]):
        w = weights[n]
        if own[n]:
            total += w
        if not np.isfinite(predicted[n]):
            if own[n]:
                wrong += w  # left unexplained
            continue
        if not depths[n] > 0.0:
            continue
        gap = depths[n] - predicted[n]
        share = min((gap / (WRONG_AT * limits[n])) ** 2, 1.0)
        if own[n]:
            wrong += w * share * (HOLLOW if gap > limits[n] else 1.0)
        elif gap > limits[n]:
            wrong += w  # seen through, whatever the distance behind
        elif gap > 0.0:
            wrong += w * share  # nearer: something else is in front
    return wrong / max(total, 1.0)


def fit_shapes(
    segment: Segment, evidence: Evidence, kinds: Sequence[str] | None = None
) -> ShapeFit:
    """Return the shape that explains a segment best, of all kinds or of those named."""
    fits = []
    for kind in kinds or PRIMITIVES.names():
        primitive = PRIMITIVES.get(kind)()
        start = primitive.start(segment.footprint)
        fits.append(_fit(kind, primitive, start, evidence, FIRST_EVALUATIONS))
    fits.sort(key=_cost)
    limit = _cost(fits[0]) + NOT_FAR
    best = [
        _fit(fit.kind, fit.primitive, fit.parameters, evidence, EVALUATIONS)
        for fit in fits[:FINALISTS] if _cost(fit) < limit
    ]  # fmt: skip
    return min(best, key=_cost)


def _cost(fit: ShapeFit) -> float:
    return fit.misfit + fit.primitive.cost


def _fit(
    kind: str, primitive: Primitive, start: Array, evidence: Evidence, evaluations: int
) -> ShapeFit:
    """Change the parameters until the misfit is least (Nelder & Mead 1965)."""
    simplex = np.vstack([start, start + np.diag(primitive.steps)])

    def cost(parameters: Array) -> float:
        return misfit(primitive, parameters, evidence) + primitive.unlikely(parameters)

    options: Any = {
        "initial_simplex": simplex, "maxfev": evaluations, "xatol": 2e-4, "fatol": 1e-4
    }  # fmt: skip
    result = minimize(cost, start, method="Nelder-Mead", options=options)
    spread = np.abs(result.final_simplex[0] - result.x).max(axis=0)[:2]
    typical = float(np.median(evidence.limits))
    std = float(np.hypot(0.002, typical * np.sqrt(result.fun)) + spread.max())
    return ShapeFit(kind, primitive, np.asarray(result.x), float(result.fun), std)
