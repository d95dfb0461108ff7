"""Where cameras stand: the file that ``igrip calibrate`` writes and ``--calibration`` reads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import CameraError
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
        said to have. None: the camera has no depth.
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
    """Write where cameras stand, as JSON.

    Parameters
    ----------
    path : str or Path
        The file.
    placements : mapping of str to Placement
        By the name of the camera.
    board : mapping
        What the board is like; kept for the record.

    Raises
    ------
    CameraError
        If the file cannot be written.
    """
    cameras = {
        name: {
            "world_from_camera": placement.world_from_camera.tolist(),
            "reprojection_px": round(placement.error, 4),
            "position_std_m": round(placement.std, 6),
        }
        for name, placement in placements.items()
    }
    content = {"format": FORMAT, "board": dict(board), "cameras": cameras}
    try:
        Path(path).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error


def read_placements(path: str | Path) -> dict[str, Array]:
    """Return ``world_from_camera``, shape (4, 4), of each camera in a file.

    Raises
    ------
    CameraError
        If the file is missing, or does not hold rigid transforms.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise ValueError(f"format must be {FORMAT!r}")
        poses = {
            str(name): np.array(camera["world_from_camera"], np.float64).reshape(4, 4)
            for name, camera in content["cameras"].items()
        }
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no calibration: {error!r}") from None
    for name, pose in poses.items():
        rotation = pose[:3, :3]
        rigid = np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-5)
        rigid = rigid and np.linalg.det(rotation) > 0 and pose[3].tolist() == [0, 0, 0, 1]
        if not np.isfinite(pose).all() or not rigid:
            raise CameraError(f"{path}: world_from_camera of {name} is no rigid transform")
    return poses
