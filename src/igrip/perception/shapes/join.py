"""Pieces of one open thing, put together: the near wall of a bowl and the far one, seen inside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from igrip.perception.registration.view import DepthView
from igrip.perception.shapes.fit_primitive import ShapeFit, evidence_of, fit_shapes
from igrip.perception.shapes.segments import STRIDE, Segment, footprint_of

MAX_SIZE = 0.4  # of what is put together, across [m]
BESIDE = 3  # pieces so near in the picture may be one [pixels of the segments' grid]
MAX_MISFIT = 0.3  # of one shape for both; guess
BETTER = 0.8  # of the misfit of two shapes, weighted by their pixels
CLEARLY = 0.06  # with a lesser misfit of one shape for both they are one
OPEN = ("cup",)  # only what is open falls into pieces


def fitted_segments(
    segments: Sequence[Segment], depth: NDArray[np.float32], view: DepthView,
    kinds: Sequence[str] | None = None,
) -> list[tuple[Segment, ShapeFit]]:  # fmt: skip
    """Fit shapes to segments (see :mod:`igrip.perception.shapes.segments`), joined where need be.

    ``kinds`` are those of the shapes, all by default. The largest come first.
    """
    fitted = [
        (segment, fit_shapes(segment, evidence_of(segment, depth, view), kinds))
        for segment in segments
    ]
    fitted.sort(key=lambda pair: -len(pair[0].points))
    k = 0
    while k < len(fitted):
        for other in range(k + 1, len(fitted)):
            joined = _joined(fitted[k], fitted[other], depth, view)
            if joined is not None:
                fitted[k] = joined
                del fitted[other]
                break
        else:
            k += 1
    return fitted


def _joined(
    one: tuple[Segment, ShapeFit], two: tuple[Segment, ShapeFit], depth: NDArray[np.float32],
    view: DepthView,
) -> tuple[Segment, ShapeFit] | None:  # fmt: skip
    """Return two pieces as one thing; None: they are two."""
    (a, fit_a), (b, fit_b) = one, two
    same = a.cluster == b.cluster
    if not same and not _beside(a, b, depth.shape):
        return None
    both = joined_segment(a, b)
    if 2.0 * both.footprint.half[0] > MAX_SIZE:
        return None
    fit = fit_shapes(both, evidence_of(both, depth, view), None if same else OPEN)
    sizes = np.array([len(a.points), len(b.points)], dtype=np.float64)
    apart = float(sizes @ [fit_a.misfit, fit_b.misfit] / sizes.sum())
    good = fit.misfit < max(CLEARLY, min(MAX_MISFIT, BETTER * apart))
    return (both, fit) if good else None


def joined_segment(a: Segment, b: Segment) -> Segment:
    """Return two segments as one."""
    points = np.vstack([a.points, b.points])
    pixels = np.vstack([a.pixels, b.pixels])
    return Segment(
        points, pixels, footprint_of(points), a.cut or b.cut, a.touched or b.touched,
        a.cluster,
    )  # fmt: skip


def _beside(a: Segment, b: Segment, shape: tuple[int, ...]) -> bool:
    """Whether two pieces touch in the picture, or nearly."""
    low_a, high_a = a.pixels.min(axis=0), a.pixels.max(axis=0)
    low_b, high_b = b.pixels.min(axis=0), b.pixels.max(axis=0)
    margin = BESIDE * STRIDE
    if (low_a > high_b + margin).any() or (low_b > high_a + margin).any():
        return False
    mask = np.zeros((shape[0] // STRIDE + 1, shape[1] // STRIDE + 1), dtype=np.bool_)
    mask[a.pixels[:, 1] // STRIDE, a.pixels[:, 0] // STRIDE] = True
    mask = binary_dilation(mask, iterations=BESIDE)
    return bool(mask[b.pixels[:, 1] // STRIDE, b.pixels[:, 0] // STRIDE].any())
