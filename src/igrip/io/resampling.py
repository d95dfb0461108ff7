"""A recorded reach resampled to the observations of a sensor."""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from igrip.entities import ObjectPose
from igrip.errors import DatasetError
from igrip.io.importers import Array, MovingObject, RecordedReach
from igrip.io.plausibility import check_length, refusal
from igrip.io.takes.take import MAX_INTERVAL_FACTOR, Track
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.observation import Observation
from igrip.settings import Settings, quantity

Gap = NDArray[np.bool_]
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


class ImportOptions(Settings):
    """Changes to the recorded movements; all of them are declared in ``dataset.json``."""

    mesh: str = "006_mustard_bottle"
    rate: float = quantity(30.0, "Hz", "samples of the dataset", "paper: 30 FPS", gt=0, le=1000)
    rest: float = quantity(0.0, "s", "rest at the start position before onset", ge=0, le=60)
    noise: float = quantity(0.0, "m", "sd of white noise added per axis", ge=0, le=1)
    seed: int = quantity(0, "1", "seed of that noise", ge=0)


def resample(reach: RecordedReach, catalog: Catalog, options: ImportOptions) -> list[Observation]:
    """Return one reach as observations at an even rate; the first also holds objects at rest.

    A mesh without a tracked pose stands upright as in its file, with the middle of its cylinder at
    the object's position.

    Raises
    ------
    DatasetError
        If the recording is much longer than its samples can tell: its unit of time is wrong.
    """
    rest = round(options.rest * options.rate) if reach.movement_only else 0
    problem = refusal(check_length(np.append(reach.times, reach.seconds), options.rate))
    if problem is not None:
        raise DatasetError(f"{reach.name}: {problem}")
    moving = int(np.floor(reach.seconds * options.rate + 1e-6)) + 1
    since_onset = np.arange(-rest, moving) / options.rate
    points = _interpolated(since_onset, reach.times, reach.positions)
    interval = float(np.median(np.diff(reach.times)))
    if reach.movement_only:
        in_gap = _in_gap(since_onset, reach.times)
    else:
        hand = Track(reach.times, reach.positions, lost=reach.lost)
        in_gap = hand.in_gap(since_onset, interval, options.rate)
    # seeded by the name, so that a reach is the same whichever others are imported
    random = np.random.default_rng([options.seed, zlib.crc32(reach.name.encode())])
    points += random.normal(0.0, 1.0, points.shape) * options.noise
    objects = {}
    for id, position in reach.object_positions.items():
        model = catalog[reach.models.get(id, options.mesh)]
        objects[id] = ObjectPose(
            model=model.name,
            position=tuple((position - model.origin).tolist()),
            orientation=UPRIGHT,
            static=True,
        )

    def gap(track: Track) -> Gap:
        return track.in_gap(since_onset, interval, options.rate)

    tracked = {
        id: _poses(
            since_onset, moved, catalog[reach.models.get(id, options.mesh)], gap(moved.track)
        )
        for id, moved in reach.moving_objects.items()
    }
    others = {
        id: _points(since_onset, track, gap(track), random, options.noise)
        for id, track in reach.other_hands.items()
    }
    return [
        Observation(
            t=k / options.rate,
            hands={reach.hand: None if in_gap[k] else {"position": point}}
            | {id: track[k] for id, track in others.items()},
            objects=(objects if k == 0 else {}) | {id: poses[k] for id, poses in tracked.items()},
        )
        for k, point in enumerate(points.tolist())
    ]


def _interpolated(times: Array, samples: Array, values: Array) -> Array:
    return np.stack([np.interp(times, samples, values[:, axis]) for axis in range(3)], axis=1)


def _in_gap(times: Array, samples: Array) -> NDArray[np.bool_]:
    """Return which times lie in gaps: no sample within 1.5 of the median interval.

    Interpolation over a gap would show an estimator where the hand is going to reappear. The rest
    before the first sample is no gap.
    """
    after = np.clip(np.searchsorted(samples, times), 1, len(samples) - 1)
    distance = np.minimum(np.abs(times - samples[after - 1]), np.abs(samples[after] - times))
    gap: NDArray[np.bool_] = distance > MAX_INTERVAL_FACTOR * np.median(np.diff(samples))
    return gap & (times > samples[0])


def _points(
    times: Array, track: Track, gap: Gap, random: np.random.Generator, noise: float
) -> list[dict[str, list[float]] | None]:
    """Return the positions of a further hand, None where it was lost."""
    if not len(track.times):
        return [None] * len(times)
    points = _interpolated(times, track.times, track.positions)
    points += random.normal(0.0, 1.0, points.shape) * noise
    return [
        None if lost else {"position": point}
        for lost, point in zip(gap, points.tolist(), strict=True)
    ]


def _poses(
    times: Array, moved: MovingObject, model: ObjectModel, gap: Gap
) -> list[ObjectPose | None]:
    """Return the poses of a tracked object's mesh, None where it was lost."""
    track = moved.track
    if not len(track.times):
        return [None] * len(times)
    points = _interpolated(times, track.times, track.positions)
    turns = np.tile(UPRIGHT, (len(times), 1))
    if track.orientations is not None:
        turns = np.tile(track.orientations[0], (len(times), 1))
        if len(track.times) > 1:
            within = np.clip(times, track.times[0], track.times[-1])
            turns = Slerp(track.times, Rotation.from_quat(track.orientations))(within).as_quat()
    if moved.pivot == "middle":
        points = points - Rotation.from_quat(turns).apply(model.origin)
    name = model.name
    return [
        None if lost else ObjectPose(model=name, position=tuple(point), orientation=tuple(turn))
        for lost, point, turn in zip(gap, points.tolist(), turns.tolist(), strict=True)
    ]
