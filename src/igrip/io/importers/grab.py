"""GRAB: whole bodies that grasp one object on a table (Taheri et al. 2020, grab.is.tue.mpg.de).

``grab/s1/mug_drink_1.npz``: ``framerate``, ``obj_name``, ``sbj_id``, and the parameters of
``lhand``, ``rhand`` (MANO) and ``object``, of each frame. The files hold pickled dictionaries; only
arrays and plain values are taken from them, so that a file cannot run code.
"""

from __future__ import annotations

import pickle
import zipfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import IO, Any

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.errors import DatasetError
from igrip.io.importers import IMPORTERS, ImportFiles, ReachReader
from igrip.io.importers._handling import find_reaches
from igrip.io.importers._mano import palms
from igrip.io.recorded_reach import RecordedReach
from igrip.io.takes.take import Track

NEEDED = ("framerate", "obj_name", "sbj_id", "lhand", "rhand", "object")
TRUSTED = {
    ("multiarray", "_reconstruct"), ("multiarray", "scalar"), ("numeric", "_frombuffer"),
    ("numpy", "ndarray"), ("numpy", "dtype"),
}  # fmt: skip


class Grab:
    """Importer of GRAB's sequences."""

    name = "GRAB (Taheri et al. 2020)"
    license = "see grab.is.tue.mpg.de; not for redistribution"
    source = (
        "Taheri, Ghorbani, Black & Tzionas (2020), ECCV. A reach ends when the object begins to "
        "move; palms from MANO's root, to about 2 cm; one object in each sequence."
    )

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether there are archives with the keys of a sequence."""
        return any(_is_sequence(path) for path in _sequences(files)[:1])

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function for each sequence."""
        return [partial(_read, path) for path in _sequences(files)]


def _sequences(files: ImportFiles) -> list[Path]:
    found = {
        path for given in files.paths
        for path in ([given] if given.is_file() else sorted(given.rglob("*.npz")))
    }  # fmt: skip
    return sorted(path for path in found if path.suffix == ".npz")


def _is_sequence(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return {f"{key}.npy" for key in NEEDED} <= set(archive.namelist())
    except (OSError, zipfile.BadZipFile):
        return False


def _read(path: Path) -> RecordedReach:
    """Return the first reach of a sequence.

    Raises
    ------
    DatasetError
        If the file is damaged or holds something else, or nobody reaches in it.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            data = {key: _array(archive.open(f"{key}.npy")) for key in NEEDED}
        rate, thing = float(data["framerate"]), str(data["obj_name"])
        hands = {
            side: _track(data[key]["params"], rate, side)
            for side, key in (("left", "lhand"), ("right", "rhand"))
        }
        object_track = _track(data["object"]["params"], rate, None)
    except (OSError, KeyError, IndexError, TypeError, ValueError, zipfile.BadZipFile,
            pickle.UnpicklingError, EOFError) as error:  # fmt: skip
        raise DatasetError(f"{path}: is no sequence of GRAB: {error!r:.120}") from error
    name = f"{path.parent.name}_{path.stem}"
    found = find_reaches(name, str(data["sbj_id"]), hands, {thing: object_track}, {})
    if not found:
        raise DatasetError(f"{path}: nobody reaches for {thing} and moves it")
    return found[0]


def _track(parameters: Any, rate: float, side: str | None) -> Track:
    places = np.asarray(parameters["transl"], dtype=np.float64)
    turns = np.asarray(parameters["global_orient"], dtype=np.float64)
    times = np.arange(len(places)) / rate
    if side is not None:
        return Track(times, palms(places, turns, side))
    # GRAB turns vertices from the right (v R), the transpose of R v
    return Track(times, places, Rotation.from_rotvec(turns).inv().as_quat())


class _TrustedUnpickler(pickle.Unpickler):
    """Unpickles arrays and plain values; anything that could run code is refused."""

    def find_class(self, module: str, name: str) -> Any:
        """Return a class or function that is trusted."""
        if (module.rpartition(".")[2], name) in TRUSTED and module.split(".")[0] == "numpy":
            return super().find_class(module.replace("numpy.core", "numpy._core"), name)
        raise pickle.UnpicklingError(f"{module}.{name} is not trusted")


def _array(file: IO[bytes]) -> Any:
    """Return what an ``.npy`` file holds: an array, or the value of an array of objects."""
    with file:
        version = np.lib.format.read_magic(file)
        read = {(1, 0): np.lib.format.read_array_header_1_0,
                (2, 0): np.lib.format.read_array_header_2_0}[version]  # fmt: skip
        shape, _, dtype = read(file)
        if dtype.hasobject:
            held = _TrustedUnpickler(file).load()
            return held.item() if isinstance(held, np.ndarray) and held.shape == () else held
        count = int(np.prod(shape, dtype=np.int64))
        values = np.frombuffer(file.read(count * dtype.itemsize), dtype)
        return values.reshape(shape) if shape else values[0]


IMPORTERS.register("grab")(Grab())
