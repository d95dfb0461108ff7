"""Nearest points: against the tree of one mesh, in the frame of the mesh."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.mesh.bvh import LEAF_BITS

LEAF_MASK = (1 << LEAF_BITS) - 1


@kernel
def _closest_on_triangle(triangles, k, px, py, pz):
    """Return the nearest point of a triangle (Ericson 2005, Real-Time Collision Detection)."""
    ax, ay, az = triangles[k, 0], triangles[k, 1], triangles[k, 2]
    bx, by, bz = triangles[k, 3], triangles[k, 4], triangles[k, 5]
    cx, cy, cz = triangles[k, 6], triangles[k, 7], triangles[k, 8]
    abx, aby, abz = bx - ax, by - ay, bz - az
    acx, acy, acz = cx - ax, cy - ay, cz - az
    apx, apy, apz = px - ax, py - ay, pz - az
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    if d1 <= 0.0 and d2 <= 0.0:
        return ax, ay, az
    bpx, bpy, bpz = px - bx, py - by, pz - bz
    d3 = abx * bpx + aby * bpy + abz * bpz
    d4 = acx * bpx + acy * bpy + acz * bpz
    if d3 >= 0.0 and d4 <= d3:
        return bx, by, bz
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0 and d1 - d3 > 0.0:  # a and b may coincide
        v = d1 / (d1 - d3)
        return ax + v * abx, ay + v * aby, az + v * abz
    cpx, cpy, cpz = px - cx, py - cy, pz - cz
    d5 = abx * cpx + aby * cpy + abz * cpz
    d6 = acx * cpx + acy * cpy + acz * cpz
    if d6 >= 0.0 and d5 <= d6:
        return cx, cy, cz
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6) if d2 - d6 > 0.0 else 0.0
        return ax + w * acx, ay + w * acy, az + w * acz
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        total = (d4 - d3) + (d5 - d6)
        w = (d4 - d3) / total if total > 0.0 else 0.0
        return bx + w * (cx - bx), by + w * (cy - by), bz + w * (cz - bz)
    scale = 1.0 / (va + vb + vc)
    v, w = vb * scale, vc * scale
    return ax + abx * v + acx * w, ay + aby * v + acy * w, az + abz * v + acz * w


@kernel
def _box_distance2(boxes, node, at, px, py, pz):
    x = max(boxes[node, at] - px, 0.0, px - boxes[node, at + 3])
    y = max(boxes[node, at + 1] - py, 0.0, py - boxes[node, at + 4])
    z = max(boxes[node, at + 2] - pz, 0.0, pz - boxes[node, at + 5])
    return x * x + y * y + z * z


@kernel
def nearest(
    boxes, links, leaves, node0, leaf0, px, py, pz, bound2, stack, near_stack, counters
):  # fmt: skip
    """Find the nearest point of the triangles, or the nearest of the points, in a tree.

    Parameters
    ----------
    boxes, links, leaves, node0, leaf0
        As for :func:`igrip.mesh.ray.cast_ray`; the leaves may be points.
    px, py, pz : float
        Query point in the frame of the mesh [m].
    bound2 : float
        Square of a distance that the result is known to be less than [m²]; infinity if unknown.
    stack, near_stack : (STACK,) int32 and float64
        Scratch memory.
    counters : (>= 2,) int64
        ``counters[1]`` counts visited nodes.

    Returns
    -------
    distance, x, y, z : float
        Of the nearest point, and where it is [m].
    """
    points = leaves.shape[1] == 3
    x = y = z = np.nan
    node = 0
    top = 0
    visited = 0
    while True:
        visited += 1
        here = np.uint64(node0 + node)  # unsigned: no test for an index from the end
        left = _box_distance2(boxes, here, 0, px, py, pz)
        right = _box_distance2(boxes, here, 6, px, py, pz)
        next_node = -1
        for turn in range(2):
            child = turn if left <= right else 1 - turn
            box_distance2 = left if child == 0 else right
            if box_distance2 >= bound2:
                continue
            link = links[here, child]
            if link >= 0:
                if next_node < 0:
                    next_node = link
                else:
                    stack[top] = link
                    near_stack[top] = box_distance2
                    top += 1
                continue
            code = -1 - link
            first = leaf0 + (code >> LEAF_BITS)
            for k in range(first, first + (code & LEAF_MASK)):
                leaf = np.uint64(k)
                if points:
                    qx, qy, qz = leaves[leaf, 0], leaves[leaf, 1], leaves[leaf, 2]
                else:
                    qx, qy, qz = _closest_on_triangle(leaves, leaf, px, py, pz)
                ux, uy, uz = qx - px, qy - py, qz - pz
                distance2 = ux * ux + uy * uy + uz * uz
                if distance2 < bound2:
                    bound2 = distance2
                    x, y, z = qx, qy, qz
        while next_node < 0:
            if top == 0:
                counters[1] += visited
                return np.sqrt(bound2), x, y, z
            top -= 1
            if near_stack[top] < bound2:
                next_node = stack[top]
        node = next_node
