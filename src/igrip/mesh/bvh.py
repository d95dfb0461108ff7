"""Bounding-volume hierarchies of one mesh, built once in the frame of its file.

Each inner node holds the boxes of its two children, so that one fetch decides both. Leaves hold
triangles or points, stored in their order. Boxes are single precision, rounded outward; what is in
the leaves is double.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel

TRIANGLES_IN_LEAF = 4
POINTS_IN_LEAF = 8
LEAF_BITS = 4  # of the number in a leaf
BINS = 16
MAX_DEPTH = 48  # beyond it ranges are halved, so that a traversal stack of 128 always suffices
STACK = 128


class Bvh(NamedTuple):
    """Tree over the triangles or the vertices of a mesh.

    Attributes
    ----------
    boxes : (n, 12) float32
        Lower and upper corner of the left child, then of the right child.
    links : (n, 2) int32
        Child node if ≥ 0; otherwise a leaf ``-1 - (16 * first + count)``.
    leaves : (f, 9) or (v, 3) float64
        Corners a, b, c of each triangle, or each vertex, in the order of the leaves [m].
    """

    boxes: NDArray[np.float32]
    links: NDArray[np.int32]
    leaves: NDArray[np.float64]


def build_bvh(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Bvh:
    """Build the tree of the triangles of a mesh.

    Parameters
    ----------
    vertices : (v, 3)
        Corners [m].
    faces : (f, 3)
        Their indices; at least one.
    """
    corners = np.ascontiguousarray(vertices[faces], dtype=np.float64)
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    return _tree(lower, upper, corners.reshape(-1, 9), TRIANGLES_IN_LEAF)


def build_point_tree(points: NDArray[np.float64]) -> Bvh:
    """Build the tree of points, shape (v, 3) [m]; at least one."""
    points = np.ascontiguousarray(points, dtype=np.float64)
    return _tree(points, points, points, POINTS_IN_LEAF)


def _tree(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    leaves: NDArray[np.float64],
    max_in_leaf: int,
) -> Bvh:
    """Build the tree of items with these bounds, at most ``max_in_leaf`` in a leaf."""
    order = np.arange(len(leaves), dtype=np.int64)
    nodes = max(1, 2 * len(leaves))
    boxes = np.empty((nodes, 6, 2))
    links = np.zeros((nodes, 2), dtype=np.int32)
    used = _build(lower, upper, order, boxes, links, max_in_leaf)
    packed = np.empty((used, 12), dtype=np.float32)
    for child in range(2):
        low, high = boxes[:used, :3, child], boxes[:used, 3:, child]
        packed[:, 6 * child : 6 * child + 3] = _round(low, -np.inf)
        packed[:, 6 * child + 3 : 6 * child + 6] = _round(high, np.inf)
    return Bvh(packed, links[:used].copy(), leaves[order])


def _round(values: NDArray[np.float64], towards: float) -> NDArray[np.float32]:
    single = values.astype(np.float32)
    inside = (single > values) if towards < 0 else (single < values)
    return np.where(inside, np.nextafter(single, np.float32(towards)), single).astype(np.float32)


@kernel
def _bounds(lower, upper, order, first, last, box, child):
    for axis in range(3):
        low, high = np.inf, -np.inf
        for k in range(first, last):
            low = min(low, lower[order[k], axis])
            high = max(high, upper[order[k], axis])
        box[axis, child] = low
        box[3 + axis, child] = high


@kernel
def _split(lower, upper, order, first, last, depth):
    """Partition a range by the binned surface-area heuristic; return where it is cut."""
    n = last - first
    middle = first + n // 2
    best_cost, best_axis, best_bin = np.inf, -1, -1
    low = np.empty(3)
    width = np.empty(3)
    for axis in range(3):
        smallest, largest = np.inf, -np.inf
        for k in range(first, last):
            centre = lower[order[k], axis] + upper[order[k], axis]
            smallest = min(smallest, centre)
            largest = max(largest, centre)
        low[axis] = smallest
        width[axis] = largest - smallest
    if depth < MAX_DEPTH:
        counts = np.empty(BINS, dtype=np.int64)
        box = np.empty((BINS, 6))
        area_right = np.empty(BINS)
        for axis in range(3):
            if not width[axis] > 0.0:
                continue
            counts[:] = 0
            box[:, :3] = np.inf
            box[:, 3:] = -np.inf
            for k in range(first, last):
                i = order[k]
                centre = lower[i, axis] + upper[i, axis]
                b = min(BINS - 1, int(BINS * (centre - low[axis]) / width[axis]))
                counts[b] += 1
                for d in range(3):
                    box[b, d] = min(box[b, d], lower[i, d])
                    box[b, 3 + d] = max(box[b, 3 + d], upper[i, d])
            run = np.empty(6)
            run[:3] = np.inf
            run[3:] = -np.inf
            right = 0
            for b in range(BINS - 1, 0, -1):
                right += counts[b]
                for d in range(3):
                    run[d] = min(run[d], box[b, d])
                    run[3 + d] = max(run[3 + d], box[b, 3 + d])
                x, y, z = run[3] - run[0], run[4] - run[1], run[5] - run[2]
                area_right[b] = right * (x * y + y * z + z * x) if right else np.inf
            run[:3] = np.inf
            run[3:] = -np.inf
            left = 0
            for b in range(BINS - 1):
                left += counts[b]
                for d in range(3):
                    run[d] = min(run[d], box[b, d])
                    run[3 + d] = max(run[3 + d], box[b, 3 + d])
                if left == 0 or left == n:
                    continue
                x, y, z = run[3] - run[0], run[4] - run[1], run[5] - run[2]
                cost = left * (x * y + y * z + z * x) + area_right[b + 1]
                if cost < best_cost:
                    best_cost, best_axis, best_bin = cost, axis, b
    if best_axis < 0:
        # all centres coincide, or the tree is too deep: halve by the widest axis
        axis = int(np.argmax(width))
        keys = np.empty(n)
        for k in range(n):
            keys[k] = lower[order[first + k], axis] + upper[order[first + k], axis]
        order[first:last] = order[first:last][np.argsort(keys, kind="mergesort")]
        return middle
    cut = first
    for k in range(first, last):
        i = order[k]
        centre = lower[i, best_axis] + upper[i, best_axis]
        b = min(BINS - 1, int(BINS * (centre - low[best_axis]) / width[best_axis]))
        if b <= best_bin:
            order[k] = order[cut]
            order[cut] = i
            cut += 1
    return cut


@kernel
def _build(lower, upper, order, boxes, links, max_in_leaf):
    """Fill ``boxes`` and ``links`` depth first; return the number of nodes."""
    stack = np.empty((4 * STACK, 4), dtype=np.int64)  # first, last, depth, node
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0, order.shape[0], 0, 0
    top, used = 1, 1
    while top > 0:
        top -= 1
        first, last, depth, node = stack[top]
        cut = last  # only the root of a tiny mesh is not split
        if last - first > max_in_leaf:
            cut = _split(lower, upper, order, first, last, depth)
        for child in range(2):
            begin = first if child == 0 else cut
            end = cut if child == 0 else last
            _bounds(lower, upper, order, begin, end, boxes[node], child)
            if end - begin <= max_in_leaf:
                links[node, child] = -1 - ((begin << LEAF_BITS) + (end - begin))
            else:
                links[node, child] = used
                stack[top, 0], stack[top, 1] = begin, end
                stack[top, 2], stack[top, 3] = depth + 1, used
                top += 1
                used += 1
    return used
