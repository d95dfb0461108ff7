"""More peers: embreex asked only whether a ray hits, and a whole frame by embreex, numpy, scipy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject
from igrip.lab.speed import scenes
from igrip.lab.speed.peers import PAPER, Embree, Recorded
from igrip.lab.speed.timing import Work
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

Array = NDArray[np.float64]
Windows = list[list[tuple[Array, Array]]]


def peers(catalog: Catalog, recorded: Recorded) -> dict[str, Work]:
    """Return every peer that is installed, as contestants."""
    contestants = recorded.embree()
    if contestants:
        embree = Embree(recorded.objects)
        rays = [embree.prepare(frame) if frame else None for frame in recorded.rays]
        whole = EmbreeNumpy(recorded.objects, PAPER.rays.rays_per_cone, 0.3, 10)
        windows = windows_of(catalog, recorded.observations)
        contestants["embreex, whether rays hit"] = lambda k: (
            embree.cast(frame, "OCCLUDED") if (frame := rays[k]) else None
        )
        contestants["embreex + numpy + scipy, frame"] = lambda k: whole.frame(windows[k])
    return contestants


def windows_of(catalog: Catalog, observations: Sequence[Observation]) -> Windows:
    """Return, for each frame and hand, the times [s] and positions [m] of its window."""
    estimator = Estimator(catalog, PAPER)
    windows = []
    for observation in observations:
        estimator.update(observation)
        windows.append(
            [
                (
                    (np.arange(len(t.trajectory)) - len(t.trajectory) + 1) / scenes.RATE,
                    t.trajectory.past,
                )
                for t in estimator.hands.values()
            ]
        )
    return windows


class EmbreeNumpy:
    """A frame as one would write it with numpy, embreex and scipy: fit, cones, rays, vertices.

    It leaves out what else the estimator does: filters, cues, target, grip, time to contact, and
    the checks of its input.

    Parameters
    ----------
    objects : sequence of PlacedObject
        The objects.
    rays, points : int
        Rays per cone, and predicted points.
    horizon : float
        How far ahead the last point is [s].
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
            Times relative to now [s] and positions [m] in the window of each hand.
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
            for hits, tree, placed in zip(
                self._embree.cast(rays), self._trees, self._objects, strict=True
            ):
                near = np.asarray(tree.query((points - placed.translation) @ placed.rotation)[0])
                results.append((hits, float(near[0]), float(near[1])))
        return results
