"""Where cameras stand: the file that ``igrip calibrate`` writes and ``--calibration`` reads."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.perception.json_files import read_json, write_json
from igrip.perception.transforms import is_rigid
from igrip.rgbd import Array

FORMAT = "igrip-calibration/1"


class Placement(NamedTuple):
    """Where a camera stands, and how surely.

    Attributes
    ----------
    world_from_camera : (4, 4)
        The world is the board's.
    error : float
        Root mean square of the distances of corners from where they should be [pixels].
    std : float
        Of the position, from the fit [m].
    tags, views : int
        How many were used.
    depth_ratio : float or None
        Measured depth of the board over that of the fit: 1 where the tags have the size they are
        assumed to have. None: the camera has no depth.
    """

    world_from_camera: Array
    error: float
    std: float
    tags: int
    views: int
    depth_ratio: float | None


def write_placements(
    path: str | Path, placements: Mapping[str, Placement], board: Mapping[str, Any]
) -> None:
    """Write where cameras stand, by their names, and what the board is like."""
    cameras = {
        name: {
            "world_from_camera": placement.world_from_camera.tolist(),
            "reprojection_px": round(placement.error, 4),
            "position_std_m": round(placement.std, 6),
        }
        for name, placement in placements.items()
    }
    write_json(path, {"format": FORMAT, "board": dict(board), "cameras": cameras})


def read_placements(path: str | Path) -> dict[str, Array]:
    """Return ``world_from_camera``, shape (4, 4), of each camera, or raise CameraError."""
    return read_json(path, "calibration", _poses)


def _poses(content: Any) -> dict[str, Array]:
    if content["format"] != FORMAT:
        raise ValueError(f"format must be {FORMAT!r}")
    poses = {
        str(name): np.array(camera["world_from_camera"], np.float64).reshape(4, 4)
        for name, camera in content["cameras"].items()
    }
    for name, pose in poses.items():
        if not is_rigid(pose, 1e-5):
            raise ValueError(f"world_from_camera of {name} is no rigid transform")
    return poses
