"""Rays against the tree of one mesh, in the frame of the mesh."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.mesh.bvh import LEAF_BITS

PARALLEL = 1e-200  # stands for a zero component of a direction: its inverse stays finite
EDGE = 1e-12  # barycentric tolerance: a ray through a shared edge must not pass between triangles
LEAF_MASK = (1 << LEAF_BITS) - 1
SLACK = 1.0 + 1e-12  # a few units in the last place, since the slabs round


@kernel
def _inverse(component):
    return 1.0 / (component if abs(component) > PARALLEL else PARALLEL)


@kernel
def _ray_triangle(triangles, k, px, py, pz, dx, dy, dz):
    """Intersect a ray with triangle k (Möller & Trumbore 1997).

    Returns whether they meet, and numerator and denominator of the ray parameter: most callers need
    no division. All conditions are computed, since a mispredicted branch costs more than they do.
    """
    ax, ay, az = triangles[k, 0], triangles[k, 1], triangles[k, 2]
    e1x, e1y, e1z = triangles[k, 3] - ax, triangles[k, 4] - ay, triangles[k, 5] - az
    e2x, e2y, e2z = triangles[k, 6] - ax, triangles[k, 7] - ay, triangles[k, 8] - az
    qx, qy, qz = dy * e2z - dz * e2y, dz * e2x - dx * e2z, dx * e2y - dy * e2x
    determinant = e1x * qx + e1y * qy + e1z * qz
    sx, sy, sz = px - ax, py - ay, pz - az
    u = sx * qx + sy * qy + sz * qz
    rx, ry, rz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    v = dx * rx + dy * ry + dz * rz
    t = e2x * rx + e2y * ry + e2z * rz
    sign = 1.0 if determinant > 0.0 else -1.0
    determinant, u, v, t = sign * determinant, sign * u, sign * v, sign * t
    lowest = -EDGE * determinant
    meets = (
        (determinant > 0.0)
        & (u >= lowest)
        & (v >= lowest)
        & (u + v <= determinant - lowest)
        & (t >= 0.0)
    )
    return meets, t, determinant


@kernel
def _box_entry(boxes, node, at, px, py, pz, ix, iy, iz, limit):
    """Return where a ray enters one of the two boxes of a node, infinity if it misses."""
    t1, t2 = (boxes[node, at] - px) * ix, (boxes[node, at + 3] - px) * ix
    near, far = min(t1, t2), max(t1, t2)
    t1, t2 = (boxes[node, at + 1] - py) * iy, (boxes[node, at + 4] - py) * iy
    near, far = max(near, min(t1, t2)), min(far, max(t1, t2))
    t1, t2 = (boxes[node, at + 2] - pz) * iz, (boxes[node, at + 5] - pz) * iz
    near, far = max(near, min(t1, t2)), min(far, max(t1, t2))
    near = max(near, 0.0)
    return near if near <= min(far, limit) * SLACK + 1e-300 else np.inf


@kernel
def meets_mesh(
    boxes, links, leaves, node0, leaf0, px, py, pz, dx, dy, dz, stack, counters
):  # fmt: skip
    """Whether a ray meets a mesh at all; the parameters are those of :func:`cast_ray`."""
    ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
    stack[0] = 0
    top = 1
    visited = 0
    met = False
    while top > 0 and not met:
        top -= 1
        node = np.uint64(node0 + stack[top])  # unsigned: no test for an index from the end
        visited += 1
        for child in range(2):
            entry = _box_entry(boxes, node, 6 * child, px, py, pz, ix, iy, iz, np.inf)
            if entry == np.inf:
                continue
            link = links[node, child]
            if link >= 0:
                stack[top] = link
                top += 1
                continue
            code = -1 - link
            first = leaf0 + (code >> LEAF_BITS)
            for k in range(first, first + (code & LEAF_MASK)):
                hit, _, _ = _ray_triangle(leaves, np.uint64(k), px, py, pz, dx, dy, dz)
                if hit:
                    met = True
                    break
    counters[0] += visited
    return met


@kernel
def count_hits(boxes, links, leaves, node0, leaf0, px, py, pz, dx, dy, dz, stack):
    """Count the triangles that a ray meets; the parameters are those of :func:`cast_ray`."""
    ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
    stack[0] = 0
    top = 1
    hits = 0
    while top > 0:
        top -= 1
        node = node0 + stack[top]
        for child in range(2):
            entry = _box_entry(boxes, node, 6 * child, px, py, pz, ix, iy, iz, np.inf)
            if entry == np.inf:
                continue
            link = links[node, child]
            if link >= 0:
                stack[top] = link
                top += 1
                continue
            code = -1 - link
            first = leaf0 + (code >> LEAF_BITS)
            for k in range(first, first + (code & LEAF_MASK)):
                hit, _, _ = _ray_triangle(leaves, k, px, py, pz, dx, dy, dz)
                if hit:
                    hits += 1
    return hits


@kernel
def cast_ray(
    boxes, links, leaves, node0, leaf0, px, py, pz, dx, dy, dz, stack, counters
):  # fmt: skip
    """Cast one ray against one mesh.

    Parameters
    ----------
    boxes, links, leaves
        Arrays of trees of triangles (:class:`igrip.mesh.bvh.Bvh`), one after the other.
    node0, leaf0 : int
        Where this mesh begins in them.
    px, py, pz, dx, dy, dz : float
        Origin and direction, in the frame of the mesh; the direction need not be a unit vector.
    stack : (STACK,) int32
        Scratch memory.
    counters : (>= 1,) int64
        ``counters[0]`` counts visited nodes.

    Returns
    -------
    float
        Distance to the nearest hit in units of the direction's length; infinity for none.
    """
    ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
    best = np.inf
    node = 0
    top = 0
    while True:
        counters[0] += 1
        left = _box_entry(boxes, node0 + node, 0, px, py, pz, ix, iy, iz, best)
        right = _box_entry(boxes, node0 + node, 6, px, py, pz, ix, iy, iz, best)
        next_node = -1
        for turn in range(2):
            child = turn if left <= right else 1 - turn
            entry = left if child == 0 else right
            if entry == np.inf:
                continue
            link = links[node0 + node, child]
            if link >= 0:
                if next_node < 0:
                    next_node = link
                else:
                    stack[top] = link
                    top += 1
                continue
            code = -1 - link
            first = leaf0 + (code >> LEAF_BITS)
            for k in range(first, first + (code & LEAF_MASK)):
                hit, t, determinant = _ray_triangle(leaves, k, px, py, pz, dx, dy, dz)
                if hit:
                    best = min(best, t / determinant)
        if next_node < 0:
            if top == 0:
                return best
            top -= 1
            next_node = stack[top]
        node = next_node
