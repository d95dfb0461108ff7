"""The same rays by other engines: embreex and trimesh's own, both optional."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.geometry.scene import PlacedObject, Scene
from igrip.motion.trajectory import Motion

Rays = Sequence[tuple[NDArray[Any], NDArray[Any]]]


def rays_of(scene: Scene, motions: Sequence[Motion], objects: Sequence[PlacedObject]) -> Rays:
    """Return the rays the estimator casts in one frame, for other engines.

    Returns
    -------
    sequence of ((n, 3), (n, 3))
        For each object, the origins [m] and directions of the rays of all hands, in the frame of
        its mesh.
    """
    rays = []
    for placed in objects:
        origins, directions = [], []
        for motion in motions:
            towards, _ = scene.impacts(motion, placed)
            used = np.isfinite(towards[:, :, 0])
            starts = np.broadcast_to(motion.future[:, None, :], towards.shape)
            origins.append((starts[used] - placed.translation) @ placed.rotation)
            directions.append(towards[used] @ placed.rotation)
        rays.append((np.concatenate(origins), np.concatenate(directions)))
    return rays


class Embree:
    """Rays by embreex, called directly for each object, with nothing else around it.

    Raises
    ------
    ImportError
        If embreex is not installed.
    """

    def __init__(self, objects: Sequence[PlacedObject]) -> None:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        self._scenes: list[Any] = []
        for placed in objects:
            scene = rtcore_scene.EmbreeScene()
            TriangleMesh(
                scene=scene,
                vertices=placed.model.vertices.astype(np.float32),
                indices=placed.model.faces.astype(np.int32),
            )
            self._scenes.append(scene)

    @staticmethod
    def prepare(rays: Rays) -> Rays:
        """Return the rays in single precision, which embree needs; not part of what is timed."""
        return [(o.astype(np.float32), d.astype(np.float32)) for o, d in rays]

    def cast(self, rays: Rays, query: str = "INTERSECT") -> list[int]:
        """Return how many rays hit each object.

        The default query is embree's nearest hit, which its Python users get; ``OCCLUDED`` asks
        only whether there is a hit (0 yes, -1 no).
        """
        return [
            int(np.count_nonzero(scene.run(origins, directions, query=query) >= 0))
            for scene, (origins, directions) in zip(self._scenes, rays, strict=True)
        ]


class PlainTrimesh:
    """Rays by trimesh without embree (its rtree engine), as in the paper's public code.

    Raises
    ------
    ImportError
        If rtree is not installed.
    """

    def __init__(self, objects: Sequence[PlacedObject]) -> None:
        from trimesh.ray.ray_triangle import RayMeshIntersector

        self._engines = [
            RayMeshIntersector(
                trimesh.Trimesh(placed.model.vertices, placed.model.faces, process=False)
            )
            for placed in objects
        ]

    def cast(self, rays: Rays) -> list[int]:
        """Return how many rays hit each object."""
        return [
            int(np.count_nonzero(engine.intersects_any(origins, directions)))
            for engine, (origins, directions) in zip(self._engines, rays, strict=True)
        ]
