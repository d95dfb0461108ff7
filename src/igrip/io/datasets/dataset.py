"""Datasets: a folder of recordings with a table of trials; docs/datasets.md has the format."""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from igrip.errors import DatasetError, RecordingError
from igrip.io.cells.values import known_text
from igrip.io.column_names import near_miss, shortened
from igrip.io.datasets.trial import Trial, read_rows, read_trials, recording_name
from igrip.io.frames import DeclaredFrame, FrameError
from igrip.io.hand_ids import match_hand
from igrip.io.recordings import SOURCES, Source, open_source
from igrip.io.text import TextError, read_text

__all__ = ["Dataset", "Trial"]

FORMAT = "igrip-dataset/1"
HEAD = 300  # messages in which a trial's hand should appear


@dataclass(frozen=True)
class Dataset:
    """A dataset on disk.

    Attributes
    ----------
    path : Path
        Its folder.
    description : mapping
        The content of ``dataset.json``.
    trials : sequence of Trial
        In the order of the table.
    """

    path: Path
    description: Mapping[str, Any]
    trials: Sequence[Trial]

    @property
    def name(self) -> str:
        """Name of the dataset."""
        return str(self.description.get("name", self.path.name))

    @property
    def objects(self) -> tuple[str, ...]:
        """Sources of its objects, for :func:`igrip.load_objects`; ``ycb`` unless it names others.

        A source that names a folder inside the dataset is returned with the dataset's path.
        """
        named = self.description.get("objects", ["ycb"])
        return tuple(str(self.path / s) if (self.path / s).is_dir() else str(s) for s in named)

    @classmethod
    def open(cls, path: str | Path, lenient: bool = False) -> Dataset:
        """Read a dataset's description and table of trials.

        Parameters
        ----------
        path : str or Path
            Its folder.
        lenient : bool
            Whether a bad number in a row becomes the ``problem`` of that row, instead of an error.

        Raises
        ------
        DatasetError
            If a file is missing or malformed; the message names file, row and column.
        """
        folder = Path(path)
        description = _read_description(folder / "dataset.json")
        return cls(folder, description, read_trials(folder / "trials.tsv", lenient))

    def recording(self, trial: Trial) -> Path:
        """Return the file of a trial's recording.

        Raises
        ------
        RecordingError
            If there is none.
        """
        name = recording_name(trial.recording)
        for part in name.split("/"):
            check_name(part)
        folder = self.path / "recordings"
        for ending in SOURCES.names():
            path = folder / f"{name}.{ending}"
            if path.is_file():
                return path
        known = self._by_name
        alike = [path for own, path in known.items() if _alike(own, name)]
        # a file in one of the folders may be named without it
        alike = alike or [path for path in known.values() if _alike(path.stem, name)]
        if len(alike) == 1:
            return alike[0]
        raise RecordingError(
            f"{folder}: no recording {name!r}{near_miss(name, list(known))}; found "
            f"{shortened(list(known), 5) or 'none'}"
        )

    def stamp(self, trial: Trial) -> str | None:
        """Return what changes when a trial's recording does; None where there is none."""
        try:
            status = self.recording(trial).stat()
        except (RecordingError, OSError):
            return None
        return f"{status.st_size}-{status.st_mtime_ns}"

    def recordings(self) -> list[Path]:
        """Return the files of all recordings, also of those that no trial names."""
        inside, endings = sorted((self.path / "recordings").rglob("*")), SOURCES.names()
        return [path for path in inside if path.suffix.lower().lstrip(".") in endings]

    @cached_property
    def _by_name(self) -> dict[str, Path]:
        """The recordings by their path in their folder, without the ending."""
        folder = self.path / "recordings"
        return {p.relative_to(folder).with_suffix("").as_posix(): p for p in self.recordings()}

    @cached_property
    def frame(self) -> DeclaredFrame:
        """The frame that ``dataset.json`` declares for the recordings; by default igrip's own.

        Raises
        ------
        DatasetError
            If it makes no frame.
        """
        declared = self.description.get("frame", {})
        try:
            return DeclaredFrame.declare(**declared)
        except (FrameError, TypeError, AttributeError) as error:
            raise DatasetError(f"{self.path / 'dataset.json'}: frame: {error}") from None

    def observations(self, trial: Trial) -> Source:
        """Open a trial's recording; its observations are in igrip's frame.

        Raises
        ------
        RecordingError
            If there is none.
        """
        return open_source(self.recording(trial), self.frame)

    def with_hand(self, trial: Trial) -> Trial:
        """Return the trial with its hand's id as the recording has it (``Right`` is ``right``)."""
        if trial.hand is None:
            return trial
        seen: set[str] = set()
        try:
            for observation in islice(self.observations(trial), HEAD):
                seen.update(observation.hands)
                if trial.hand in seen:
                    return trial
        except RecordingError:  # whoever reads it whole will name the place
            pass
        return replace(trial, hand=match_hand(trial.hand, sorted(seen)) or trial.hand)

    def participants_without_trials(self) -> list[str]:
        """Return the participants that have a row in their table, but no trial."""
        try:
            header, rows = read_rows(self.path / "participants.tsv")
            column = [name.lower().removesuffix("_id") for name in header].index("participant")
        except (DatasetError, ValueError):
            return []  # the table is optional
        named = [known_text(cells[column]) for _, cells in rows if column < len(cells)]
        present = {trial.participant for trial in self.trials}
        if present <= {None}:
            return []  # the trials have no column of participants
        return sorted({name for name in named if name and name not in present})


def check_name(name: str) -> None:
    """Raise an error for a name that would lead out of its folder."""
    if not name or name in (".", "..") or any(c in name for c in "/\\\0") or name.startswith("."):
        raise DatasetError(f"a recording cannot be named {name!r:.80}")


def _alike(one: str, other: str) -> bool:
    """Return whether two names differ by case or Unicode's normal form alone."""
    forms = [unicodedata.normalize("NFC", name).casefold() for name in (one, other)]
    return forms[0] == forms[1]


def _read_description(path: Path) -> Mapping[str, Any]:
    try:
        description = json.loads(read_text(path))
    except FileNotFoundError:
        raise DatasetError(f"{path.parent}: is not a dataset: it has no dataset.json") from None
    except TextError as error:
        raise DatasetError(str(error)) from error
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: {error}") from error
    if not isinstance(description, dict) or description.get("format") != FORMAT:
        raise DatasetError(f"{path}: its format must be {FORMAT!r}")
    objects = description.get("objects", [])
    if not isinstance(objects, list) or not all(isinstance(source, str) for source in objects):
        raise DatasetError(f"{path}: objects must be a list of strings")
    return description
