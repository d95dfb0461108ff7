"""Single rays and nearest points through the compiled queries, and through embree."""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from igrip.mesh import nearest as nearest_points
from igrip.mesh import ray
from igrip.mesh.bvh import STACK


def cast(bvh, origins, directions):
    """Return the length of each ray, infinity for a miss."""
    stack, counters = np.empty(STACK, dtype=np.int32), np.zeros(3, dtype=np.int64)
    lengths = np.empty(len(origins))
    for k, (p, d) in enumerate(zip(origins, directions, strict=True)):
        lengths[k] = ray.cast_ray(*bvh, 0, 0, *p, *d, stack, counters)
    return lengths


def meets(bvh, origins, directions):
    """Return whether each ray meets the mesh."""
    stack, counters = np.empty(STACK, dtype=np.int32), np.zeros(3, dtype=np.int64)
    return np.array(
        [
            ray.meets_mesh(*bvh, 0, 0, *p, *d, stack, counters)
            for p, d in zip(origins, directions, strict=True)
        ],
        dtype=bool,
    )


def nearest(tree, point, least2=np.inf):
    """Return the distance to the nearest of a tree, where that is, and how many nodes it took."""
    stack, near = np.empty(STACK, dtype=np.int32), np.empty(STACK)
    counters = np.zeros(3, dtype=np.int64)
    found = nearest_points.nearest(*tree, 0, 0, *point, least2, stack, near, counters)
    return found[0], np.array(found[1:]), int(counters[1])


def embree_lengths(corners, origins, directions):
    """Return the length of each ray by embree, in single precision; infinity for a miss."""
    scene = EmbreeScene()
    TriangleMesh(scene, corners.astype(np.float32))
    origins, directions = origins.astype(np.float32), directions.astype(np.float32)
    hit = scene.run(origins, directions) >= 0
    return np.where(hit, scene.run(origins, directions, query="DISTANCE"), np.inf)


def towards(rng, corners, count, spread=0.3):
    """Return origins round a mesh, and directions to points in and round it."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    middle, size = 0.5 * (low + high), float(np.linalg.norm(high - low))
    origins = middle + rng.normal(0.0, size, (count, 3))
    targets = middle + rng.uniform(-0.6, 0.6, (count, 3)) * (high - low)
    targets += rng.normal(0.0, spread * 0.1 * size, (count, 3))
    return origins, targets - origins
