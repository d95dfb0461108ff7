"""Frames that are timed, with the rays that other engines need to do the same work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject
from igrip.lab.speed import scenes
from igrip.lab.speed.engines import Embree, PlainTrimesh, Rays, rays_of
from igrip.lab.speed.timing import Work, interleaved, percentiles
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

PAPER = Config(targets="paper")
EMBREE = "embreex, rays alone"
TRIMESH = "trimesh without embree, rays alone"
WARM_UP = 40  # frames before the clock runs: the window is full and the code compiled


def warm(estimator: Estimator, observations: Sequence[Observation]) -> Estimator:
    """Feed an estimator the warm-up frames and return it."""
    for observation in observations[:WARM_UP]:
        estimator.update(observation)
    return estimator


@dataclass
class Recorded:
    """What other engines need to do the estimator's work.

    Attributes
    ----------
    observations : list of Observation
        The frames; the first :data:`WARM_UP` are not timed.
    objects : sequence of PlacedObject
        The objects after the last frame.
    rays : list of Rays or None
        The rays of each frame; None where no hand moves.
    missing : list of str
        Packages that are not installed, so that their rows are left out.
    """

    observations: list[Observation]
    objects: Sequence[PlacedObject]
    rays: list[Rays | None]
    missing: list[str] = field(default_factory=list)

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
