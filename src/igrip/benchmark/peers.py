"""The same rays by other engines; each is optional (embreex and rtree are no dependencies)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from igrip.geometry.scene import PlacedObject, Scene
from igrip.motion.trajectory import Motion

Array = NDArray[np.float64]


class Workload:
    """What one frame asks of a ray engine: for each object, origins and directions in its frame.

    Attributes
    ----------
    rays : list of ((n, 3), (n, 3))
        For each object, the rays of all hands.
    points : list of (m, 3)
        For each object, the points whose distance is wanted: hands and barycentres.
    """

    def __init__(
        self, scene: Scene, motions: Sequence[Motion], objects: Sequence[PlacedObject]
    ) -> None:
        self.rays: list[tuple[Array, Array]] = []
        self.points: list[Array] = []
        for placed in objects:
            origins, directions, points = [], [], []
            for motion in motions:
                towards, _ = scene.impacts(motion, placed)
                used = np.isfinite(towards[:, :, 0])
                starts = np.broadcast_to(motion.future[:, None, :], towards.shape)
                origins.append((starts[used] - placed.translation) @ placed.rotation)
                directions.append(towards[used] @ placed.rotation)
                points += [motion.position, motion.future.mean(axis=0)]
            self.rays.append((np.concatenate(origins), np.concatenate(directions)))
            self.points.append((np.array(points) - placed.translation) @ placed.rotation)


def mesh_of(placed: PlacedObject) -> trimesh.Trimesh:
    """Return the mesh of an object for other libraries."""
    return trimesh.Trimesh(placed.model.vertices, placed.model.faces, process=False)


class Embree:
    """Rays by embreex, called directly for each object; with nothing else around it."""

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
    def prepare(workload: Workload) -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]:
        """Return the rays in the form embreex takes; not part of what is timed."""
        return [(o.astype(np.float32), d.astype(np.float32)) for o, d in workload.rays]

    def cast(
        self,
        rays: Sequence[tuple[NDArray[np.float32], NDArray[np.float32]]],
        query: str = "INTERSECT",
    ) -> list[int]:
        """Return how many rays meet each object.

        By default embree's nearest hit, which is what its Python users get; ``OCCLUDED`` asks only
        whether there is one (0 yes, -1 no).
        """
        return [
            int(np.count_nonzero(scene.run(origins, directions, query=query) >= 0))
            for scene, (origins, directions) in zip(self._scenes, rays, strict=True)
        ]


class EmbreeNumpy:
    """A frame as one would write it with numpy, embreex and scipy: fit, cones, rays, vertices.

    It leaves out what the estimator does besides: filters, cues, target, grip,
    time to contact, and the checks of its input.
    """

    def __init__(
        self, objects: Sequence[PlacedObject], rays: int, horizon: float, points: int
    ) -> None:
        self._objects = objects
        self._embree = Embree(objects)
        self._trees = [cKDTree(placed.model.vertices) for placed in objects]
        self._disc = np.random.default_rng(0).uniform(-1.0, 1.0, (rays, 2))
        self._steps = np.arange(1, points + 1)[:, None] * horizon / points

    def frame(self, windows: Sequence[tuple[Array, Array]]) -> list[tuple[int, float, float]]:
        """Return impacts and both distances for each hand and object.

        Parameters
        ----------
        windows : sequence of ((n,), (n, 3))
            Times relative to now and positions in the window of each hand.
        """
        results = []
        for times, positions in windows:
            powers = np.stack([np.ones_like(times), times, times**2], axis=1)
            weighted = powers / (1.0 - times)[:, None]
            c = np.linalg.solve(powers.T @ weighted, weighted.T @ positions)
            future = c[0] + self._steps * c[1] + self._steps**2 * c[2]
            velocity = c[1] + 2.0 * self._steps * c[2]
            speed = np.linalg.norm(velocity, axis=1, keepdims=True)
            axis = velocity / np.maximum(speed, 1e-9)
            tangent = np.tan(np.interp(speed[:, 0], [0.03, 0.8], np.radians([25.0, 8.0])))
            u = np.cross(axis, [0.0, 0.0, 1.0])
            u /= np.maximum(np.linalg.norm(u, axis=1, keepdims=True), 1e-9)
            v = np.cross(axis, u)
            spread = tangent[:, None, None] * self._disc
            directions = axis[:, None] + spread[..., :1] * u[:, None] + spread[..., 1:] * v[:, None]
            origins = np.broadcast_to(future[:, None], directions.shape).reshape(-1, 3)
            directions = directions.reshape(-1, 3)
            rays = [
                (
                    ((origins - placed.translation) @ placed.rotation).astype(np.float32),
                    (directions @ placed.rotation).astype(np.float32),
                )
                for placed in self._objects
            ]
            points = np.array([positions[-1], future.mean(axis=0)])
            for met, tree, placed in zip(
                self._embree.cast(rays), self._trees, self._objects, strict=True
            ):
                near = np.asarray(tree.query((points - placed.translation) @ placed.rotation)[0])
                results.append((met, float(near[0]), float(near[1])))
        return results


class PlainTrimesh:
    """Rays by trimesh without embree (its rtree engine), as the paper's public code uses."""

    def __init__(self, objects: Sequence[PlacedObject]) -> None:
        from trimesh.ray.ray_triangle import RayMeshIntersector

        self._engines = [RayMeshIntersector(mesh_of(placed)) for placed in objects]

    def cast(self, workload: Workload) -> list[int]:
        """Return how many rays meet each object."""
        return [
            int(np.count_nonzero(engine.intersects_any(origins, directions)))
            for engine, (origins, directions) in zip(self._engines, workload.rays, strict=True)
        ]
