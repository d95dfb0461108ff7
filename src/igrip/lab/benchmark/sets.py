"""Sets of the benchmark: who is judged, and where a declared set comes from."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from igrip.errors import DatasetError, UnknownNameError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.shared import address_of, open_dataset
from igrip.io.importers import IMPORTERS
from igrip.lab.benchmark.entries import NAME
from igrip.lab.evaluation.runner import spread

FOLDS, JUDGED = 5, 1
DESCRIPTION = "dataset.json"


@dataclass(frozen=True)
class DeclaredSet:
    """A public set that users download themselves.

    Attributes
    ----------
    importer : str
        Of its files; see ``igrip list importers``.
    source : str
        Where it is.
    """

    importer: str
    source: str


DECLARED = {
    "near_far": DeclaredSet("wispinski2021", "Wispinski et al. 2021, near and far reaches"),
    "dexycb": DeclaredSet("dexycb", "Chao et al. 2021, dex-ycb.github.io"),
    "grab": DeclaredSet("grab", "Taheri et al. 2020, grab.is.tue.mpg.de"),
    "hot3d": DeclaredSet("hot3d", "Banerjee et al. 2025, facebookresearch.github.io/hot3d"),
}


def is_judged(participant: str | None) -> bool:
    """Return whether a participant of a declared set is judged; entries may learn from the others.

    One in five, by a checksum of the pseudonym: the same people for everybody, for good.
    """
    return zlib.crc32((participant or "").encode()) % FOLDS == JUDGED


@dataclass(frozen=True)
class BenchmarkSet:
    """One set.

    Attributes
    ----------
    name : str
        In the table.
    dataset : Dataset
        On disk.
    trials : sequence of Trial
        Those that are judged.
    split : str
        Which people these are, in words.
    """

    name: str
    dataset: Dataset
    trials: Sequence[Trial]
    split: str

    def spread(self, limit: int) -> BenchmarkSet:
        """Return the set with at most so many trials, evenly spread; 0: all."""
        return replace(self, trials=spread(self.trials, limit))


def open_set(name: str, folder: Path) -> BenchmarkSet:
    """Open a set: of a declared one, the people who are judged; of any other, everybody.

    Raises
    ------
    DatasetError
        If the folder is no dataset or another one, or nobody in it is judged.
    """
    dataset = open_dataset(folder, lenient=True)
    if name not in DECLARED:
        return BenchmarkSet(name, dataset, dataset.trials, "everybody")
    expected = IMPORTERS.get(DECLARED[name].importer).name
    if dataset.name != expected:
        raise DatasetError(
            f"{folder}: holds {dataset.name!r:.60}, not {expected!r}; give the set another name "
            f"than {name}"
        )
    trials = [trial for trial in dataset.trials if is_judged(trial.participant)]
    if not trials:
        raise DatasetError(
            f"{folder}: none of its people is among those who are judged (one in {FOLDS}); to "
            "judge everybody, give the set another name"
        )
    return BenchmarkSet(name, dataset, trials, f"one person in {FOLDS}, by checksum")


def parse_set(text: str) -> tuple[str, Path]:
    """Return name and folder from ``NAME=FOLDER``, or from a folder, which names the set.

    Raises
    ------
    DatasetError
        If there is no such folder.
    UnknownNameError
        If the folder is no dataset, and the name is not that of a declared set.
    """
    name, equals, folder = text.partition("=")
    path = Path(folder if equals else text)
    name = name if equals else path.resolve().name
    if NAME.fullmatch(name) is None:
        raise DatasetError(f"{name!r:.60}: a set's name has letters, digits, - and _")
    if address_of(path) is not None:
        return name, path
    if not path.is_dir():
        raise DatasetError(f"{path}: there is no such folder; give NAME=FOLDER")
    if not (path / DESCRIPTION).is_file() and name not in DECLARED:
        raise UnknownNameError("declared set", name, tuple(DECLARED))
    return name, path
