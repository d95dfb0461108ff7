"""HOT3D: hands and 33 objects in daily actions (Banerjee et al. 2025, facebookresearch/hot3d).

A folder for each sequence, ``P0001_10a27bf7``, with ``dynamic_objects.csv`` (a row for each object
and time) and ``hand_data/umetrack_hand_pose_trajectory.jsonl`` (wrists); ``instance.json`` beside
it or in ``assets`` names the objects.
"""

from __future__ import annotations

import csv
import json
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError
from igrip.io.importers import IMPORTERS, ImportFiles, ReachReader
from igrip.io.importers._handling import find_reaches
from igrip.io.recorded_reach import RecordedReach
from igrip.io.takes.take import Track

OBJECTS = ("dynamic_objects.csv", "dynamic_objects_v2.csv")
HANDS = ("umetrack_hand_pose_trajectory.jsonl", "hand_pose_trajectory.jsonl")
SIDES = {"0": "left", "1": "right"}
PLACE = ("t_wo_x[m]", "t_wo_y[m]", "t_wo_z[m]")
TURN = ("q_wo_x", "q_wo_y", "q_wo_z", "q_wo_w")


class Hot3d:
    """Importer of HOT3D's sequences."""

    name = "HOT3D (Banerjee et al. 2025)"
    license = "see facebookresearch.github.io/hot3d"
    source = (
        "Banerjee et al. (2025), CVPR. A reach ends when an object that had rested begins to move. "
        "Hands are wrists, not palms; the world is that of the headset, gravity along -z."
    )

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether there is a folder with objects and hands of a sequence."""
        return bool(_sequences(files))

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function for each reach of all sequences."""
        found = [reach for folder in _sequences(files) for reach in read_sequence(folder)]
        return [lambda reach=reach: reach for reach in found]  # type: ignore[misc]


def _sequences(files: ImportFiles) -> list[Path]:
    folders = {
        path.parent for given in files.paths if given.is_dir()
        for name in OBJECTS for path in given.rglob(name)
    }  # fmt: skip
    return sorted(folder for folder in folders if _hands_of(folder) is not None)


def _hands_of(folder: Path) -> Path | None:
    places = (folder / part / name for part in ("hand_data", "") for name in HANDS)
    return next((path for path in places if path.is_file()), None)


def read_sequence(folder: Path) -> list[RecordedReach]:
    """Return the reaches of one sequence.

    Raises
    ------
    DatasetError
        If a file of it is damaged; the message names it.
    """
    table = next(folder / name for name in OBJECTS if (folder / name).is_file())
    hands = _hands_of(folder)
    assert hands is not None
    try:
        objects, start = _read_objects(table, _names(folder))
        tracks = _read_hands(hands, start)
    except (OSError, KeyError, ValueError, TypeError) as error:
        raise DatasetError(f"{folder}: is no sequence of HOT3D: {error!r:.120}") from error
    return find_reaches(folder.name, folder.name.partition("_")[0], tracks, objects, {})


def _names(folder: Path) -> dict[str, str]:
    """Return the names of objects by their identifiers; empty where they are not there."""
    for place in (folder.parent / "assets", folder.parent, folder):
        path = place / "instance.json"
        if path.is_file():
            known = json.loads(path.read_text(encoding="utf-8"))
            return {str(uid): str(one.get("instance_name", uid)) for uid, one in known.items()}
    return {}


def _read_objects(path: Path, names: dict[str, str]) -> tuple[dict[str, Track], int]:
    """Return the objects' tracks, and the first timestamp [ns], from which times count."""
    rows: dict[str, dict[int, list[float]]] = defaultdict(dict)
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            uid = row["object_uid"]
            pose = [float(row[column]) for column in (*PLACE, *TURN)]
            rows[names.get(uid, uid)][int(row["timestamp[ns]"])] = pose
    start = min((min(poses) for poses in rows.values()), default=0)
    return {id: _track(poses, start) for id, poses in rows.items()}, start


def _read_hands(path: Path, start: int) -> dict[str, Track]:
    rows: dict[str, dict[int, list[float]]] = defaultdict(dict)
    with path.open(encoding="utf-8") as file:
        for line in file:
            message: dict[str, Any] = json.loads(line)
            for key, hand in message["hand_poses"].items():
                if key in SIDES:
                    wrist = hand["wrist_xform"]
                    w, x, y, z = wrist["q_wxyz"]
                    rows[SIDES[key]][int(message["timestamp_ns"])] = [*wrist["t_xyz"], x, y, z, w]
    return {id: _track(poses, start) for id, poses in rows.items()}


def _track(poses: dict[int, list[float]], start: int) -> Track:
    stamps = sorted(poses)
    values = np.array([poses[stamp] for stamp in stamps])
    turns = values[:, 3:] / np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
    return Track((np.array(stamps) - start) * 1e-9, values[:, :3], turns)


IMPORTERS.register("hot3d")(Hot3d())
