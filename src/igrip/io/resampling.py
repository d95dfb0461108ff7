"""A recorded reach resampled to the observations of a sensor."""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.io.importers import Array, RecordedReach
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.settings import Settings, quantity


class ImportOptions(Settings):
    """Changes to the recorded movements; all of them are declared in ``dataset.json``."""

    mesh: str = "006_mustard_bottle"
    rate: float = quantity(30.0, "Hz", "samples of the dataset", "paper: 30 FPS", gt=0, le=1000)
    rest: float = quantity(0.0, "s", "rest at the start position before onset", ge=0, le=60)
    noise: float = quantity(0.0, "m", "sd of white noise added per axis", ge=0, le=1)
    seed: int = quantity(0, "1", "seed of that noise", ge=0)


def resample(reach: RecordedReach, catalog: Catalog, options: ImportOptions) -> list[Observation]:
    """Return one reach as observations at an even rate; the first also holds the objects.

    Each mesh stands upright as in its file, with the middle of its cylinder at the object's
    position.
    """
    rest = round(options.rest * options.rate) if reach.movement_only else 0
    moving = int(np.floor(reach.times[-1] * options.rate + 1e-6)) + 1
    since_onset = np.arange(-rest, moving) / options.rate
    points = np.stack(
        [np.interp(since_onset, reach.times, reach.positions[:, axis]) for axis in range(3)], axis=1
    )
    in_gap = _in_gap(since_onset, reach.times)
    # seeded by the name, so that a reach is the same whichever others are imported
    random = np.random.default_rng([options.seed, zlib.crc32(reach.name.encode())])
    points += random.normal(0.0, 1.0, points.shape) * options.noise
    objects = {}
    for id, position in reach.object_positions.items():
        model = catalog[reach.models.get(id, options.mesh)]
        objects[id] = ObjectPose(
            model=model.name,
            position=tuple((position - model.origin).tolist()),
            orientation=(0.0, 0.0, 0.0, 1.0),
            static=True,
        )
    return [
        Observation(
            t=k / options.rate,
            hands={reach.hand: None if in_gap[k] else {"position": point}},
            objects=objects if k == 0 else {},
        )
        for k, point in enumerate(points.tolist())
    ]


def _in_gap(times: Array, samples: Array) -> NDArray[np.bool_]:
    """Return which times lie in gaps: no sample within 1.5 of the median interval.

    Interpolation over a gap would show an estimator where the hand is going to reappear.
    """
    after = np.clip(np.searchsorted(samples, times), 1, len(samples) - 1)
    distance = np.minimum(np.abs(times - samples[after - 1]), np.abs(samples[after] - times))
    gap: NDArray[np.bool_] = (distance > 1.5 * np.median(np.diff(samples))) & (times > samples[0])
    return gap
