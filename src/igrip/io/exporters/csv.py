"""Plain tables: one of trials, one of each recording, one that explains the columns."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from pathlib import Path

from igrip.errors import RecordingError
from igrip.io.datasets.dataset import Dataset
from igrip.io.datasets.trial import COLUMNS
from igrip.io.exporters import EXPORTERS
from igrip.io.exporters._tracks import track_entities

EXPLAINED = (
    ("t", "s", "time of the message, on the recording's clock"),
    ("hand_ID_x, _y, _z", "m", "palm centre; right-handed frame, z up where gravity is known"),
    ("hand_ID_qx, _qy, _qz, _qw", "1", "rotation of the hand, unit quaternion"),
    ("object_ID_x, _y, _z", "m", "origin of the object's mesh"),
    ("object_ID_qx, _qy, _qz, _qw", "1", "rotation of the mesh, unit quaternion"),
    ("an empty cell", "", "not seen in this message"),
)


@EXPORTERS.register("csv")
def export_csv(dataset: Dataset, folder: Path, on_recording: Callable[[], object]) -> list[str]:
    """Write ``trials.csv``, ``columns.csv`` and ``recordings/NAME.csv``."""
    problems: list[str] = []
    more = sorted({name for trial in dataset.trials for name in trial.extra})
    rows = [asdict(trial) | dict(trial.extra) for trial in dataset.trials]
    columns = [*COLUMNS, *more]
    _write(folder / "trials.csv", columns, ([row.get(c) for c in columns] for row in rows))
    _write(folder / "columns.csv", ["column", "unit", "meaning"], EXPLAINED)
    for trial in dataset.trials:
        path = folder / "recordings" / f"{trial.recording}.csv"
        try:
            tracks = track_entities(dataset.observations(trial))
        except RecordingError as error:
            problems.append(f"{trial.recording}: {error}")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            named = [(f"{one.name}_{c}", v) for one in tracks.tracks for c, v in one.columns()]
            cells = zip(tracks.times, *(values for _, values in named), strict=True)
            header = ["t", *(name for name, _ in named)]
            _write(path, header, ([_cell(x) for x in row] for row in cells))
        on_recording()
    return problems


def _cell(value: float) -> str:
    return "" if value != value else f"{value:.9g}"


def _write(path: Path, header: Sequence[str], rows: Iterable[Iterable[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
