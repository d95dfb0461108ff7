"""Rays and nearest points against the tree of one mesh, in the frame of the mesh."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel

PARALLEL = 1e-200  # stands for a zero component of a direction: its inverse stays finite
EDGE = 1e-12  # barycentric tolerance: a ray through a shared edge must not slip between triangles


@kernel
def _ray_triangle(triangle, px, py, pz, dx, dy, dz):
    """Return the ray parameter of the hit, infinity for none (Möller & Trumbore 1997)."""
    ax, ay, az = triangle[0], triangle[1], triangle[2]
    e1x, e1y, e1z = triangle[3] - ax, triangle[4] - ay, triangle[5] - az
    e2x, e2y, e2z = triangle[6] - ax, triangle[7] - ay, triangle[8] - az
    qx, qy, qz = dy * e2z - dz * e2y, dz * e2x - dx * e2z, dx * e2y - dy * e2x
    determinant = e1x * qx + e1y * qy + e1z * qz
    if determinant == 0.0:
        return np.inf
    inverse = 1.0 / determinant
    sx, sy, sz = px - ax, py - ay, pz - az
    u = (sx * qx + sy * qy + sz * qz) * inverse
    if not (u >= -EDGE and u <= 1.0 + EDGE):
        return np.inf
    rx, ry, rz = sy * e1z - sz * e1y, sz * e1x - sx * e1z, sx * e1y - sy * e1x
    v = (dx * rx + dy * ry + dz * rz) * inverse
    if not (v >= -EDGE and u + v <= 1.0 + EDGE):
        return np.inf
    t = (e2x * rx + e2y * ry + e2z * rz) * inverse
    return t if t >= 0.0 else np.inf


@kernel
def _box_entry(box, at, px, py, pz, ix, iy, iz, limit):
    """Return where a ray enters one of the two boxes of a node, infinity if it misses."""
    t1, t2 = (box[at] - px) * ix, (box[at + 3] - px) * ix
    near, far = min(t1, t2), max(t1, t2)
    t1, t2 = (box[at + 1] - py) * iy, (box[at + 4] - py) * iy
    near, far = max(near, min(t1, t2)), min(far, max(t1, t2))
    t1, t2 = (box[at + 2] - pz) * iz, (box[at + 5] - pz) * iz
    near, far = max(near, min(t1, t2)), min(far, max(t1, t2))
    near = max(near, 0.0)
    # a few units in the last place of slack, since the slabs round
    return near if near <= min(far, limit) * (1.0 + 1e-12) + 1e-300 else np.inf


@kernel
def cast_ray(
    boxes, links, triangles, node0, triangle0, px, py, pz, dx, dy, dz, any_hit, stack, counters
):
    """Cast one ray against one mesh.

    Parameters
    ----------
    boxes, links, triangles
        Arrays of :class:`igrip.geometry.bvh.Bvh`, of several meshes one after the other.
    node0, triangle0 : int
        Where this mesh begins in them.
    px, py, pz, dx, dy, dz : float
        Origin and direction, in the frame of the mesh; the direction need not be a unit vector.
    any_hit : bool
        True: stop at the first hit that is found, which need not be the nearest.
    stack : (STACK,) int32
        Scratch memory.
    counters : (>= 1,) int64
        ``counters[0]`` counts visited nodes.

    Returns
    -------
    float
        Distance to the hit in units of the direction's length; infinity for none.
    """
    ix = 1.0 / (dx if abs(dx) > PARALLEL else PARALLEL)
    iy = 1.0 / (dy if abs(dy) > PARALLEL else PARALLEL)
    iz = 1.0 / (dz if abs(dz) > PARALLEL else PARALLEL)
    best = np.inf
    node = 0
    top = 0
    while True:
        counters[0] += 1
        box = boxes[node0 + node]
        left = _box_entry(box, 0, px, py, pz, ix, iy, iz, best)
        right = _box_entry(box, 6, px, py, pz, ix, iy, iz, best)
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
            first = triangle0 + (code >> 3)
            for k in range(first, first + (code & 7)):
                t = _ray_triangle(triangles[k], px, py, pz, dx, dy, dz)
                if t < best:
                    best = t
                    if any_hit:
                        return best
        if next_node < 0:
            if top == 0:
                return best
            top -= 1
            next_node = stack[top]
        node = next_node


@kernel
def _closest_on_triangle(triangle, px, py, pz):
    """Return the nearest point of a triangle (Ericson 2005, Real-Time Collision Detection)."""
    ax, ay, az = triangle[0], triangle[1], triangle[2]
    bx, by, bz = triangle[3], triangle[4], triangle[5]
    cx, cy, cz = triangle[6], triangle[7], triangle[8]
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
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3) if d1 - d3 > 0.0 else 0.0
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
def _box_distance2(box, at, px, py, pz):
    x = max(box[at] - px, 0.0, px - box[at + 3])
    y = max(box[at + 1] - py, 0.0, py - box[at + 4])
    z = max(box[at + 2] - pz, 0.0, pz - box[at + 5])
    return x * x + y * y + z * z


@kernel
def nearest(
    boxes, links, triangles, node0, triangle0, px, py, pz, vertices, vertex2, surface2,
    stack, near_stack, counters,
):  # fmt: skip
    """Find the nearest surface point and, if asked, the nearest vertex of one mesh.

    Parameters
    ----------
    boxes, links, triangles, node0, triangle0
        As for :func:`cast_ray`.
    px, py, pz : float
        Query point in the frame of the mesh [m].
    vertices : bool
        Whether the nearest vertex is wanted as well.
    vertex2, surface2 : float
        Squares of distances that the results are known to be less than [m²]; infinity if unknown.
    stack, near_stack : (STACK,) int32 and float64
        Scratch memory.
    counters : (>= 2,) int64
        ``counters[1]`` counts visited nodes.

    Returns
    -------
    vertex, surface, x, y, z, vx, vy, vz : float
        Distance to the nearest vertex (infinity if not asked) and surface point, that point, and
        that vertex [m].
    """
    if not vertices:
        vertex2 = np.inf
    x = y = z = vx = vy = vz = np.nan
    node = 0
    top = 0
    while True:
        counters[1] += 1
        box = boxes[node0 + node]
        left = _box_distance2(box, 0, px, py, pz)
        right = _box_distance2(box, 6, px, py, pz)
        next_node = -1
        for turn in range(2):
            child = turn if left <= right else 1 - turn
            away = left if child == 0 else right
            # no vertex is nearer than the surface: the looser of the two bounds decides
            if away >= (vertex2 if vertices else surface2):
                continue
            link = links[node0 + node, child]
            if link >= 0:
                if next_node < 0:
                    next_node = link
                else:
                    stack[top] = link
                    near_stack[top] = away
                    top += 1
                continue
            code = -1 - link
            first = triangle0 + (code >> 3)
            for k in range(first, first + (code & 7)):
                triangle = triangles[k]
                if vertices:
                    for corner in range(0, 9, 3):
                        ux = triangle[corner] - px
                        uy = triangle[corner + 1] - py
                        uz = triangle[corner + 2] - pz
                        distance2 = ux * ux + uy * uy + uz * uz
                        if distance2 < vertex2:
                            vertex2 = distance2
                            vx, vy, vz = (
                                triangle[corner],
                                triangle[corner + 1],
                                triangle[corner + 2],
                            )
                if away >= surface2:
                    continue
                qx, qy, qz = _closest_on_triangle(triangle, px, py, pz)
                ux, uy, uz = qx - px, qy - py, qz - pz
                distance2 = ux * ux + uy * uy + uz * uz
                if distance2 < surface2:
                    surface2 = distance2
                    x, y, z = qx, qy, qz
        while next_node < 0:
            if top == 0:
                return np.sqrt(vertex2), np.sqrt(surface2), x, y, z, vx, vy, vz
            top -= 1
            if near_stack[top] < (vertex2 if vertices else surface2):
                next_node = stack[top]
        node = next_node
