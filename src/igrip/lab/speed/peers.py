"""The rays of the frames that are timed, by other engines: embreex and trimesh, both optional."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject, Scene
from igrip.lab.speed import scenes
from igrip.lab.speed.timing import Work, interleaved, percentiles
from igrip.motion.trajectory import Motion
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

PAPER = Config(targets="paper")
EMBREE = "embreex, rays alone"
TRIMESH = "trimesh without embree, rays alone"
WARM_UP = 40  # frames before the clock runs: the window is full and the code compiled
Rays = Sequence[tuple[NDArray[Any], NDArray[Any]]]
"""For each object, origins (n, 3) [m] and directions (n, 3) of rays in the frame of its mesh."""


def warm(estimator: Estimator, observations: Sequence[Observation]) -> Estimator:
    """Feed an estimator the warm-up frames and return it."""
    for observation in observations[:WARM_UP]:
        estimator.update(observation)
    return estimator


def rays_of(scene: Scene, motions: Sequence[Motion], objects: Sequence[PlacedObject]) -> Rays:
    """Return the rays that the estimator casts for all hands in one frame."""
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
    """Rays by embreex, called directly for each object, with nothing else around it."""

    def __init__(self, objects: Sequence[PlacedObject]) -> None:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        self._scenes: list[Any] = [rtcore_scene.EmbreeScene() for _ in objects]
        for scene, placed in zip(self._scenes, objects, strict=True):
            vertices, faces = placed.model.vertices, placed.model.faces
            TriangleMesh(
                scene=scene, vertices=vertices.astype(np.float32), indices=faces.astype(np.int32)
            )

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
    """Rays by trimesh without embree (its rtree engine), as in the paper's public code."""

    def __init__(self, objects: Sequence[PlacedObject]) -> None:
        from trimesh.ray.ray_triangle import RayMeshIntersector

        meshes = [trimesh.Trimesh(o.model.vertices, o.model.faces, process=False) for o in objects]
        self._engines = [RayMeshIntersector(mesh) for mesh in meshes]

    def cast(self, rays: Rays) -> list[int]:
        """Return how many rays hit each object."""
        return [
            int(np.count_nonzero(engine.intersects_any(origins, directions)))
            for engine, (origins, directions) in zip(self._engines, rays, strict=True)
        ]


@dataclass
class Recorded:
    """What other engines need to do the estimator's work."""

    observations: list[Observation]  # the first WARM_UP are not timed
    objects: Sequence[PlacedObject]  # after the last frame
    rays: list[Rays | None]  # of each frame; None where no hand moves
    missing: list[str] = field(default_factory=list)  # packages that are not installed

    @classmethod
    def run(cls, catalog: Catalog, frames: int) -> Recorded:
        """Run the estimator over the scene that is timed, and keep the rays it casts."""
        observations = scenes.frames(WARM_UP + frames)
        estimator = Estimator(catalog, PAPER)
        rays: list[Rays | None] = []
        for observation in observations:
            estimator.update(observation)
            motions = [t.motion for t in estimator.hands.values() if t.motion is not None]
            rays.append(rays_of(estimator.scene, motions, estimator.objects) if motions else None)
        return cls(observations, estimator.objects, rays)

    def embree(self) -> dict[str, Work]:
        """Return embreex as a contestant; nothing where it is not installed."""
        try:
            engine = Embree(self.objects)
        except ImportError as error:
            self.missing.append(str(error))
            return {}
        rays = [Embree.prepare(frame) if frame else None for frame in self.rays]
        return {EMBREE: lambda k: engine.cast(frame) if (frame := rays[k]) else None}

    def plain_trimesh(self, frames: int) -> dict[str, float] | None:
        """Time trimesh without embree on some of the frames; each takes up to seconds."""
        if not frames:
            return None
        every = max(1, len(self.rays) // frames)
        chosen = [frame for frame in self.rays if frame is not None][WARM_UP::every][:frames]
        try:
            engine = PlainTrimesh(self.objects)
            times = interleaved({"rays": lambda k: engine.cast(chosen[k])}, range(len(chosen)))
        except ImportError as error:
            self.missing.append(str(error))
            return None
        return percentiles(times["rays"])
