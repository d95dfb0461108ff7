"""A recorded reach resampled to the observations of a sensor."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from igrip.entities import ObjectPose
from igrip.errors import DatasetError, UnknownModelError
from igrip.io.importers import Array, MovingObject, RecordedReach
from igrip.io.plausibility import check_length, refusal
from igrip.io.takes.take import MAX_INTERVAL_FACTOR, Track
from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.observation import Observation
from igrip.settings import Settings, quantity

Gap = NDArray[np.bool_]
CHUNK = 4096  # observations that are made at a time
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


class ImportOptions(Settings):
    """Changes to the recorded movements; all of them are declared in ``dataset.json``."""

    mesh: str = "006_mustard_bottle"
    rate: float = quantity(30.0, "Hz", "samples of the dataset", "paper: 30 FPS", gt=0, le=1000)
    rest: float = quantity(0.0, "s", "rest at the start position before onset", ge=0, le=60)
    noise: float = quantity(0.0, "m", "sd of white noise added per axis", ge=0, le=1)
    seed: int = quantity(0, "1", "seed of that noise", ge=0)


def resample(reach: RecordedReach, catalog: Catalog, options: ImportOptions) -> list[Observation]:
    """Return all of :func:`observations_of` at once."""
    return list(observations_of(reach, catalog, options))


def observations_of(
    reach: RecordedReach, catalog: Catalog, options: ImportOptions
) -> Iterator[Observation]:
    """Yield one reach as observations at an even rate; the first also holds objects at rest.

    A mesh without a tracked pose stands upright as in its file, with the middle of its cylinder at
    the object's position. A part of the reach is in memory at a time.

    Raises
    ------
    DatasetError
        If the recording is much longer than its samples explain: its unit of time is wrong.
    UnknownModelError
        If the catalogue lacks the model of an object.
    """
    problem = refusal(check_length(np.append(reach.times, reach.seconds), options.rate))
    if problem is not None:
        raise DatasetError(f"{reach.name}: {problem}")
    models = {
        id: _model_of(id, reach, catalog, options)
        for id in (*reach.object_positions, *reach.moving_objects)
    }
    at_rest = {
        id: ObjectPose(
            model=models[id].name,
            position=tuple((position - models[id].origin).tolist()),
            orientation=UPRIGHT,
            static=True,
        )
        for id, position in reach.object_positions.items()
    }
    rest = round(options.rest * options.rate) if reach.movement_only else 0
    stop = int(np.floor(reach.seconds * options.rate + 1e-6)) + 1
    noise = {id: _noise(reach, options, id) for id in (None, *reach.other_hands)}
    for start in range(-rest, stop, CHUNK):
        numbers = np.arange(start, min(start + CHUNK, stop))
        times = numbers / options.rate  # since onset
        hands, objects = _entities(reach, models, options, times, noise)
        for row, number in enumerate((numbers + rest).tolist()):
            yield Observation(
                t=number / options.rate,
                hands={id: positions[row] for id, positions in hands.items()},
                objects=(at_rest if number == 0 else {})
                | {id: poses[row] for id, poses in objects.items()},
            )


def _model_of(
    id: str, reach: RecordedReach, catalog: Catalog, options: ImportOptions
) -> ObjectModel:
    """Return the model that the reach names, else the one with the object's name, else the mesh."""
    if id in reach.models:
        return catalog[reach.models[id]]
    try:
        return catalog[id if id in catalog else options.mesh]
    except UnknownModelError as error:
        raise UnknownModelError(
            f"object {id!r:.60} names no model, and {error}: name one in the map (model = …) or "
            f"with --mesh; the catalogue has: {', '.join(list(catalog)[:6])}"
            f"{', …' if len(catalog) > 6 else ''}"
        ) from None


Position = dict[str, list[float]] | None


def _entities(
    reach: RecordedReach,
    models: Mapping[str, ObjectModel],
    options: ImportOptions,
    times: Array,
    noise: Mapping[str | None, np.random.Generator],
) -> tuple[dict[str, list[Position]], dict[str, list[ObjectPose | None]]]:
    """Return the hands and the tracked objects at some times."""
    interval = float(np.median(np.diff(reach.times)))
    hand = Track(reach.times, reach.positions, lost=reach.lost)

    def gap(track: Track) -> Gap:
        return track.in_gap(times, interval, options.rate)

    lost = _in_gap(times, reach.times) if reach.movement_only else gap(hand)
    hands = {reach.hand: _points(times, hand, lost, noise[None], options.noise)}
    for id, track in reach.other_hands.items():
        hands[id] = _points(times, track, gap(track), noise[id], options.noise)
    objects = {
        id: _poses(times, moved, models[id], gap(moved.track))
        for id, moved in reach.moving_objects.items()
    }
    return hands, objects


def _noise(reach: RecordedReach, options: ImportOptions, id: str | None) -> np.random.Generator:
    """Return a source of noise; seeded by names, whichever other reaches are imported."""
    names = [reach.name] if id is None else [reach.name, id]
    return np.random.default_rng([options.seed, *(zlib.crc32(name.encode()) for name in names)])


def _interpolated(times: Array, samples: Array, values: Array) -> Array:
    return np.stack([np.interp(times, samples, values[:, axis]) for axis in range(3)], axis=1)


def _in_gap(times: Array, samples: Array) -> NDArray[np.bool_]:
    """Return which times lie in gaps: no sample within 1.5 of the median interval.

    Interpolation over a gap would show an estimator where the hand is going to reappear. The rest
    before the first sample is no gap.
    """
    after = np.clip(np.searchsorted(samples, times), 1, len(samples) - 1)
    distance = np.minimum(np.abs(times - samples[after - 1]), np.abs(samples[after] - times))
    far = distance > MAX_INTERVAL_FACTOR * np.median(np.diff(samples))
    gap: NDArray[np.bool_] = far & (times > samples[0])
    return gap


def _points(
    times: Array, track: Track, gap: Gap, random: np.random.Generator, noise: float
) -> list[Position]:
    """Return the positions of a hand, None where it was lost."""
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
