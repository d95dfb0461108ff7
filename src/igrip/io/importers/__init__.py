"""From a table of reaches to a dataset: place meshes, add rest and sensor noise, and say so."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from igrip.entities import ObjectPose
from igrip.errors import DatasetError, MissingExtraError
from igrip.io.datasets.dataset import Dataset, DatasetWriter, Trial
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.registry import Registry
from igrip.settings import Settings, quantity

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedReach:
    """One recorded movement of one hand towards one of several objects.

    Attributes
    ----------
    name : str
        Name of the recording.
    participant, trial, hand, target : str
        Whose it is, which, with which hand and to which object.
    times : (n,)
        Seconds from movement onset, increasing.
    positions : (n, 3)
        Of the hand [m].
    places : mapping of str to (3,)
        Where each object is [m].
    extra : mapping of str to str
        Further columns of the table of trials.
    grip, movement : str or None
        Of the task.
    models : mapping of str to str
        Model of each object, where it is not that of the options.
    whole : bool
        Whether the samples are the movement and nothing else. If not, onset and end are left to the
        evaluation, and nothing is added before.
    """

    name: str
    participant: str
    trial: str
    hand: str
    target: str
    times: Array
    positions: Array
    places: Mapping[str, Array]
    extra: Mapping[str, str] = field(default_factory=dict)
    grip: str | None = None
    movement: str | None = None
    models: Mapping[str, str] = field(default_factory=dict)
    whole: bool = True

    def __post_init__(self) -> None:
        good = len(self.times) > 1 and np.isfinite(self.times).all()
        if not good or not (np.diff(self.times) > 0).all():
            raise DatasetError(f"{self.name}: its times do not increase, or there are not two")
        if not np.isfinite(self.positions).all():
            raise DatasetError(f"{self.name}: has positions that are not finite")
        if not all(np.isfinite(place).all() for place in self.places.values()):
            raise DatasetError(f"{self.name}: an object has no finite place")
        if self.target not in self.places:
            raise DatasetError(f"{self.name}: its target {self.target!r} has no place")


class Importer(Protocol):
    """One layout of tables."""

    name: str
    license: str
    source: str

    def recognises(self, tables: Mapping[str, pd.DataFrame]) -> bool:
        """Whether these tables (by file stem) have this layout."""
        ...

    def reaches(self, tables: Mapping[str, pd.DataFrame]) -> Sequence[Callable[[], RecordedReach]]:
        """Return one function per reach, so that a long import can show progress."""
        ...


IMPORTERS: Registry[Importer] = Registry("importer", "igrip.io.importers", "igrip.importers")


class ImportOptions(Settings):
    """What is done to the recorded movements; all of it is declared in ``dataset.json``."""

    mesh: str = "006_mustard_bottle"
    rate: float = quantity(30.0, "Hz", "samples of the dataset", "paper: 30 FPS", gt=0, le=1000)
    rest: float = quantity(0.0, "s", "rest at the start position before onset", ge=0, le=60)
    noise: float = quantity(0.0, "m", "sd of white noise added per axis", ge=0, le=1)
    seed: int = quantity(0, "1", "seed of that noise", ge=0)


def read_tables(paths: Iterable[Path]) -> dict[str, pd.DataFrame]:
    """Read tables by file stem; a folder stands for the tables in it.

    Raises
    ------
    MissingExtraError
        If pandas or pyarrow are not installed.
    DatasetError
        If a file cannot be read as a table, or two have one stem.
    """
    try:
        import pandas as pd
        import pyarrow  # noqa: F401 - pandas needs it for parquet
    except ImportError as error:
        raise MissingExtraError(error.name or "pandas", "tables", "importing tables") from error
    readers: dict[str, Callable[[Path], Any]] = {
        ".parquet": pd.read_parquet,
        ".csv": pd.read_csv,
        ".tsv": lambda path: pd.read_csv(path, sep="\t"),
    }
    files: list[Path] = []
    for path in paths:
        inside = sorted(p for p in path.iterdir() if p.suffix in readers) if path.is_dir() else []
        files += inside or [path]
    tables: dict[str, pd.DataFrame] = {}
    for path in files:
        if path.suffix not in readers:
            raise DatasetError(f"{path}: expected a file {', '.join(readers)} or a folder of them")
        if path.stem in tables:
            raise DatasetError(f"{path}: two tables are named {path.stem!r}")
        try:
            tables[path.stem] = readers[path.suffix](path)
        except (OSError, ValueError) as error:
            raise DatasetError(f"{path}: cannot be read as a table: {error}") from error
    return tables


def find_importer(tables: Mapping[str, pd.DataFrame]) -> Importer:
    """Return the importer that recognises the tables.

    Raises
    ------
    DatasetError
        If none does.
    """
    for name in IMPORTERS.names():
        importer = IMPORTERS.get(name)
        if importer.recognises(tables):
            return importer
    seen = "; ".join(f"{name}: {', '.join(map(str, t.columns))}" for name, t in tables.items())
    known = ", ".join(IMPORTERS.names())
    raise DatasetError(f"no importer recognises these tables (known: {known}). Found {seen}")


def observe(reach: RecordedReach, catalog: Catalog, options: ImportOptions) -> list[Observation]:
    """Return one reach as a recording: objects first, then the hand at an even rate.

    The mesh stands upright as in its file, the middle of its cylinder at the object's place.
    """
    rest = round(options.rest * options.rate) if reach.whole else 0
    moving = int(np.floor(reach.times[-1] * options.rate + 1e-6)) + 1
    since_onset = np.arange(-rest, moving) / options.rate
    points = np.stack(
        [np.interp(since_onset, reach.times, reach.positions[:, axis]) for axis in range(3)], axis=1
    )
    # seeded by the name, so that a reach is the same whichever others are imported
    lost = _far_from_samples(since_onset, reach.times)
    random = np.random.default_rng([options.seed, zlib.crc32(reach.name.encode())])
    points += random.normal(0.0, 1.0, points.shape) * options.noise
    objects = {}
    for id, place in reach.places.items():
        model = catalog[reach.models.get(id, options.mesh)]
        objects[id] = ObjectPose(
            model=model.name,
            position=tuple((place - model.origin).tolist()),
            orientation=(0.0, 0.0, 0.0, 1.0),
            static=True,
        )
    return [
        Observation(
            t=k / options.rate,
            hands={reach.hand: None if lost[k] else {"position": point}},
            objects=objects if k == 0 else {},
        )
        for k, point in enumerate(points.tolist())
    ]


def _far_from_samples(times: Array, samples: Array) -> NDArray[np.bool_]:
    """Return which times fall into gaps: no sample within 1.5 of their usual interval.

    Bridging a gap would tell an estimator where the hand is going to appear.
    """
    after = np.clip(np.searchsorted(samples, times), 1, len(samples) - 1)
    away = np.minimum(np.abs(times - samples[after - 1]), np.abs(samples[after] - times))
    far: NDArray[np.bool_] = (away > 1.5 * np.median(np.diff(samples))) & (times > samples[0])
    return far


def write_dataset(
    importer: Importer,
    reaches: Sequence[Callable[[], RecordedReach]],
    out: Path,
    catalog: Catalog,
    options: ImportOptions,
    objects: Sequence[str],
    problems: list[str] | None = None,
) -> Iterator[Dataset | None]:
    """Write a dataset; yields None after each reach and the dataset at the end.

    A reach that cannot be used is left out: ``problems`` then says which and why. Without that list
    it raises :class:`DatasetError`.
    """
    writer = DatasetWriter(
        out,
        name=importer.name,
        license=importer.license,
        source=importer.source,
        objects=list(objects),
        derived={
            "mesh": f"{options.mesh}, upright, the middle of its cylinder at each object's place",
            "resampled_to_hz": options.rate,
            "rest_before_onset_s": options.rest,
            "added_noise_sd_m": options.noise,
            "seed": options.seed,
        },
    )
    onset = round(options.rest * options.rate) / options.rate  # rest is a whole number of samples
    with writer:
        for read in reaches:
            try:
                reach = read()
            except DatasetError as error:
                if problems is None:
                    raise
                problems.append(str(error))
                yield None
                continue
            trial = Trial(
                recording=reach.name,
                participant=reach.participant,
                trial=reach.trial,
                hand=reach.hand,
                target=reach.target,
                grip=reach.grip,
                movement=reach.movement,
                onset_s=round(onset, 6) if reach.whole else None,
                end_s=round(onset + float(reach.times[-1]), 6) if reach.whole else None,
                extra=reach.extra,
            )
            writer.add(trial, observe(reach, catalog, options))
            yield None
        yield writer.close()
