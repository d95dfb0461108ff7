"""Takes as motion-capture systems export them, without a map of columns.

Hands are the bodies whose names are those of hands; all other rigid bodies are objects. What else a
trial needs (who, which target) stands in a map.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from functools import cache, partial
from pathlib import Path

from igrip.errors import DatasetError
from igrip.io.column_map import ColumnMap, ObjectColumns, SampleColumns
from igrip.io.column_names import trial_column
from igrip.io.hand_ids import is_hand
from igrip.io.importers import IMPORTERS, ImportFiles, ReachReader, RecordedReach
from igrip.io.mapped_takes import takes_in, trial_id
from igrip.io.mapped_trial import TrialReader
from igrip.io.tables import Table
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import read_take
from igrip.io.takes.roles import hands_of, objects_of
from igrip.io.takes.sections import merge_tracking_systems
from igrip.io.takes.take import Take

PLAIN = ("table", "table without a header")
TakeReader = Callable[[], Take]


class MotionCapture:
    """Importer of the exports of Motive, QTM, Vicon, and of TRC, C3D and Motion-BIDS files.

    Parameters
    ----------
    declared : Declared, optional
        What the user declares of the files.
    catalog : container of str, optional
        A body that is named as one of its models is that object.
    """

    name = "Motion capture"
    license = "unknown"
    source = "unknown"

    def __init__(self, declared: Declared | None = None, catalog: Container[str] = ()) -> None:
        self._declared = declared or Declared()
        self._catalog = catalog

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether a file has one of these layouts, or a column of a hand's position."""
        return any(_is_take(source) for source in files.opened.values())

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function per take."""
        chosen = {name: source for name, source in files.opened.items() if _is_take(source)}
        chosen = merge_tracking_systems(chosen)
        takes: list[tuple[str, TakeReader]] = []
        for name, source in chosen.items():
            takes += _readers(name, source, self._declared)
        return [self._reader(number, *take) for number, take in enumerate(takes, 1)]

    def _reader(self, number: int, name: str, read_one: TakeReader) -> ReachReader:
        def read() -> RecordedReach:
            take = read_one()
            objects = objects_of(take)
            columns = ColumnMap(
                objects={
                    id: ObjectColumns(body=key, model=key if key in self._catalog else None)
                    for id, key in objects.items()
                }
            )
            if not hands_of(take):
                raise DatasetError(
                    f"{take.name}: no body has the name of a hand (bodies: "
                    f"{', '.join(take.tracks)}); "
                    'write a map with [hands.right] body = "…": igrip import --inspect FILE '
                    "--write-map map.toml"
                )
            return TrialReader(columns, self._declared, number, None, {}, {name: take}, name)()

        return read


def _readers(
    name: str, source: Table | Path | DatasetError, declared: Declared
) -> list[tuple[str, TakeReader]]:
    """Return a function for each take of a source; a column of trials separates them."""
    if isinstance(source, DatasetError):
        return [(name, partial(_failing, source))]
    column = None if isinstance(source, Path) else trial_column(source.columns)
    if isinstance(source, Path) or column is None:
        return [(name, partial(read_take, name, source, declared))]
    columns = ColumnMap(samples=SampleColumns(trial=column))

    @cache
    def trials() -> dict[str, Take | DatasetError]:
        return takes_in(name, source, columns, declared)

    def read(trial: str) -> Take:
        take = trials()[trial]
        if isinstance(take, DatasetError):
            raise take
        return take

    ids = dict.fromkeys(trial_id(text) for text in source.texts(source.find(column)))
    return [(trial, partial(read, trial)) for trial in ids]


def _failing(error: DatasetError) -> Take:
    raise error


def _is_take(source: Table | Path | DatasetError) -> bool:
    if isinstance(source, DatasetError):
        return False
    if isinstance(source, Path):
        return True
    layout = source.layout
    if layout.name not in PLAIN:
        return True
    timed = layout.time is not None or layout.rate is not None
    return timed and any(is_hand(body.name) for body in layout.bodies if body.name)


IMPORTERS.register("motion_capture")(MotionCapture())
