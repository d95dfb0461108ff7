"""DexYCB: grasps of YCB objects among others (Chao et al. 2021, dex-ycb.github.io).

``20200709-subject-01/20200709_141754`` holds ``meta.yml`` (which object is grasped, with which
hand), ``pose.npz`` (poses of the objects in the frame of the master camera) and, for each camera,
``labels_000000.npz`` (the hand's joints); ``calibration/extrinsics_…/extrinsics.yml`` has the poses
of cameras and of the tag that lies on the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.errors import DatasetError, requires_extra
from igrip.io.importers import IMPORTERS, ImportFiles, ReachReader
from igrip.io.importers._handling import find_reaches
from igrip.io.recorded_reach import RecordedReach
from igrip.io.takes.take import Array, Track
from igrip.objects.catalog import YCB_VIDEO

RATE = 30.0  # frames a second
PALM = (0, 5, 9, 13, 17)  # joints whose mean is the palm: wrist and knuckles of four fingers
MISSING = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])  # a pose that is not known


class DexYcb:
    """Importer of DexYCB's sequences."""

    name = "DexYCB (Chao et al. 2021)"
    license = "CC BY-NC 4.0"
    source = (
        "Chao et al. (2021), CVPR. A reach ends when the grasped object begins to move. Poses are "
        "those of the set's own meshes of YCB objects, in the frame of the tag on the table."
    )

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether there is a folder of a sequence, with its poses."""
        return bool(_sequences(files))

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function for each sequence."""
        return [partial(read_sequence, folder) for folder in _sequences(files)]


def _sequences(files: ImportFiles) -> list[Path]:
    folders = {
        path.parent for given in files.paths if given.is_dir() for path in given.rglob("meta.yml")
    }
    return sorted(folder for folder in folders if (folder / "pose.npz").is_file())


def read_sequence(folder: Path) -> RecordedReach:
    """Return the reach of one sequence.

    Raises
    ------
    DatasetError
        If a file is missing or damaged, or the object is not moved; the message names the folder.
    MissingExtraError
        If PyYAML is not installed.
    """
    with requires_extra("pyyaml", "benchmark", "DexYCB"):
        import yaml
    try:
        meta = _read(folder / "meta.yml")
        calibration = folder.parent.parent / "calibration" / f"extrinsics_{meta['extrinsics']}"
        extrinsics = _read(calibration / "extrinsics.yml")["extrinsics"]
        poses = {k: _matrix(v) for k, v in extrinsics.items()}
        table_from_world: Array = np.linalg.inv(poses["apriltag"]).astype(np.float64)
        names = [YCB_VIDEO[int(number) - 1] for number in meta["ycb_ids"]]
        side = str(meta["mano_sides"][0])
        with np.load(folder / "pose.npz", allow_pickle=False) as archive:
            objects = _objects(archive["pose_y"], names, table_from_world)
        hand = _hand(folder, meta, poses, table_from_world)
        target = names[int(meta["ycb_grasp_ind"])]
    except (OSError, KeyError, IndexError, TypeError, ValueError, BadZipFile, yaml.YAMLError,
            np.linalg.LinAlgError) as error:  # fmt: skip
        raise DatasetError(f"{folder}: is no sequence of DexYCB: {error!r:.120}") from error
    person = "subject-" + folder.parent.name.rpartition("-")[2]
    models = {name: name for name in names}
    found = find_reaches(folder.name, person, {side: hand}, objects, models, only=target)
    if not found:
        raise DatasetError(f"{folder}: {target} is not taken")
    return found[0]


def _objects(poses: Array, names: Sequence[str], table_from_world: Array) -> dict[str, Track]:
    """Return the tracks of objects from poses (n, o, 7): quaternion x, y, z, w, and place."""
    times = np.arange(len(poses)) / RATE
    turn = Rotation.from_matrix(table_from_world[:3, :3])
    tracks = {}
    for k, name in enumerate(names):
        own = np.asarray(poses[:, k], dtype=np.float64)
        seen = (own != MISSING).any(axis=1)
        places = own[seen, 4:] @ table_from_world[:3, :3].T + table_from_world[:3, 3]
        turns = (turn * Rotation.from_quat(own[seen, :4])).as_quat() if seen.any() else None
        tracks[name] = Track(times[seen], places, turns)
    return tracks


def _hand(
    folder: Path, meta: dict[str, Any], poses: dict[str, Array], table_from_world: Array
) -> Track:
    """Return the palm's track: of each frame, from the first camera that has the joints."""
    times, places = [], []
    for frame in range(int(meta["num_frames"])):
        for serial in meta["serials"]:
            path = folder / serial / f"labels_{frame:06d}.npz"
            if not path.is_file():
                continue
            with np.load(path, allow_pickle=False) as labels:
                joints = np.asarray(labels["joint_3d"], dtype=np.float64).reshape(-1, 3)
            if (joints != -1.0).any():
                palm = joints[list(PALM)].mean(axis=0)
                world = poses[serial] @ [*palm, 1.0]
                times.append(frame / RATE)
                places.append((table_from_world @ world)[:3])
                break
    return Track(np.array(times), np.array(places).reshape(-1, 3))


def _read(path: Path) -> Any:
    """Return the content of a YAML file, every scalar as text.

    YAML 1.1 takes ``20200702_151821``, the name of a calibration, for a number.
    """
    import yaml

    return yaml.load(path.read_text(encoding="utf-8"), Loader=yaml.BaseLoader)


def _matrix(values: Any) -> Array:
    """Return a pose (4, 4) from twelve numbers, row after row."""
    return np.vstack([np.array(values, dtype=np.float64).reshape(3, 4), [0.0, 0.0, 0.0, 1.0]])


IMPORTERS.register("dexycb")(DexYcb())
