"""Where cameras stand: found from a board of tags that all of them see, kept in a small file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from igrip.perception.calibration.board import Board, CornerFinder
from igrip.perception.cameras import CameraError
from igrip.rgbd import Array, Intrinsics, RgbdFrame
from igrip.settings import Settings, quantity

FORMAT = "igrip-calibration/1"


class CalibrationConfig(Settings):
    """How much must be seen, and how well it must fit."""

    views: int = quantity(30, "1", "pictures of each camera that are used at most", "guess", ge=1)
    tags: int = quantity(4, "1", "tags that must be seen, at least", "guess", ge=2)
    worst: float = quantity(1.0, "pixels", "reprojection error, root mean square, at most", "guess")
    still: float = quantity(1.5, "pixels", "a corner may move between pictures, at most", "guess")
    outlier: float = quantity(0.5, "pixels", "errors beyond this count less (soft L1)", "guess")
    doubt: float = quantity(
        1.2, "1", "the mirrored pose must fit worse than the best by this factor", "guess", ge=1
    )


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


class Views:
    """What one camera saw of the board: its corners and, where it has depth, how far they were."""

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.intrinsics = intrinsics
        self.corners: list[Mapping[int, Array]] = []
        self.depths: list[Mapping[int, float]] = []

    def add(self, frame: RgbdFrame, corners: Mapping[int, Array]) -> None:
        """Take one picture in."""
        self.corners.append(corners)
        if frame.depth is None:
            return
        far: dict[int, float] = {}
        for id, four in corners.items():
            u, v = np.round(four.mean(axis=0)).astype(int)
            part = frame.depth[max(0, v - 2) : v + 3, max(0, u - 2) : u + 3]
            if (part > 0).any():
                far[id] = float(np.median(part[part > 0]))
        self.depths.append(far)


def collect(
    frames: Iterable[RgbdFrame],
    board: Board,
    seconds: float = 5.0,
    cameras: int = 1,
    config: CalibrationConfig | None = None,
) -> dict[str, Views]:
    """Watch the board for some seconds of the frames' own time; return what each camera saw.

    It is done earlier once so many cameras have given as many pictures as are used.
    """
    config = config or CalibrationConfig()
    finder = CornerFinder(board)
    views: dict[str, Views] = {}
    first: float | None = None
    for frame in frames:
        first = frame.t if first is None else first
        own = views.setdefault(frame.camera, Views(frame.intrinsics))
        if own.intrinsics != frame.intrinsics:
            raise CameraError(f"the intrinsics of {frame.camera} change while it is calibrated")
        if len(own.corners) < config.views:
            own.add(frame, finder.find(frame))
        enough = all(len(seen.corners) >= config.views for seen in views.values())
        if frame.t - first >= seconds or (enough and len(views) >= cameras):
            break
    return views


def place_camera(
    name: str, views: Views, board: Board, config: CalibrationConfig | None = None
) -> Placement:
    """Find where a camera stands.

    Each corner is the median of those in all pictures; the pose is the least-squares fit of all
    corners (soft L1), begun from both solutions of a plane's pose (Collins & Bartoli 2014, IPPE).

    Raises
    ------
    CameraError
        If too little is seen, something moved, or the fit is poor; the message says what to do.
    """
    config = config or CalibrationConfig()
    pixels, points, ids = _medians(name, views, board, config)
    k = views.intrinsics
    fits = [_refine(start, pixels, points, k, config) for start in _starts(pixels, points, k)]
    fits.sort(key=lambda fit: float(fit.cost))
    best = fits[0]
    misses = np.linalg.norm(_misses(best.x, pixels, points, k).reshape(-1, 2), axis=1)
    error = float(np.sqrt(np.mean(misses**2)))
    if error > config.worst:
        raise CameraError(
            f"{name}: corners lie {error:.2f} pixels from where they should (at most "
            f"{config.worst:g}): is the board flat and printed as it is described, and is the "
            "camera's lens calibrated?"
        )
    for other in fits[1:]:
        turned = Rotation.from_rotvec(best.x[:3]) * Rotation.from_rotvec(other.x[:3]).inv()
        if turned.magnitude() > 0.02 and other.cost < config.doubt**2 * best.cost:
            raise CameraError(
                f"{name}: two poses fit the board equally well: bring it nearer, or look at it "
                "from further aside"
            )
    camera_from_world = _matrix(best.x)
    covariance = np.linalg.pinv(best.jac.T @ best.jac) * error**2 / 2
    std = float(np.sqrt(np.trace(covariance[3:, 3:])))
    return Placement(
        np.asarray(np.linalg.inv(camera_from_world), np.float64), error, std, len(ids),
        len(views.corners), _depth_ratio(views, camera_from_world, board),
    )  # fmt: skip


def _medians(
    name: str, views: Views, board: Board, config: CalibrationConfig
) -> tuple[Array, Array, Sequence[int]]:
    """Return pixels (n, 2) and points (n, 3) of all corners, and the tags they belong to."""
    pixels, points, ids, moved = [], [], [], []
    for id in board.ids:
        seen = np.array([corners[id] for corners in views.corners if id in corners])
        if len(seen) >= max(1, len(views.corners) // 2):
            middle = np.median(seen, axis=0)
            moved.append(np.percentile(np.linalg.norm(seen - middle, axis=2), 90))
            pixels.append(middle)
            points.append(board.corners(id))
            ids.append(id)
    if len(ids) < config.tags:
        raise CameraError(
            f"{name}: sees {len(ids)} tags of the board, {config.tags} are needed: is it in the "
            "picture, flat, near and well lit?"
        )
    if np.median(moved) > config.still:
        raise CameraError(f"{name}: the board or the camera moved; let both rest")
    return np.concatenate(pixels), np.concatenate(points), ids


def _starts(pixels: Array, points: Array, k: Intrinsics) -> list[Array]:
    """Return rotation vector and translation of both poses of a plane that look like this."""
    try:
        import cv2
    except ImportError:
        raise CameraError("calibration needs OpenCV: pip install opencv-python-headless") from None
    found = cv2.solvePnPGeneric(points, pixels, k.matrix, None, flags=cv2.SOLVEPNP_IPPE)
    starts = [
        np.concatenate([turn.ravel(), far.ravel()])
        for turn, far in zip(found[1], found[2], strict=True)
    ]
    if not starts:
        raise CameraError("no pose of a camera explains these corners")
    return starts


def _refine(
    start: Array, pixels: Array, points: Array, k: Intrinsics, config: CalibrationConfig
) -> Any:
    return least_squares(
        _misses, start, args=(pixels, points, k), loss="soft_l1", f_scale=config.outlier,
        x_scale="jac",
    )  # fmt: skip


def _misses(pose: Array, pixels: Array, points: Array, k: Intrinsics) -> Array:
    seen = Rotation.from_rotvec(pose[:3]).apply(points) + pose[3:]
    misses: Array = (k.pixels(seen) - pixels).ravel()
    return misses


def _matrix(pose: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_rotvec(pose[:3]).as_matrix()
    matrix[:3, 3] = pose[3:]
    return matrix


def _depth_ratio(views: Views, camera_from_world: Array, board: Board) -> float | None:
    ratios = []
    for far in views.depths:
        for id, depth in far.items():
            centre = np.append(board.corners(id).mean(axis=0), 1.0)
            ratios.append(depth / float(camera_from_world[2] @ centre))
    return float(np.median(ratios)) if ratios else None


def write_calibration(path: str | Path, placements: Mapping[str, Placement], board: Board) -> None:
    """Write where cameras stand, as JSON.

    Raises
    ------
    CameraError
        If the file cannot be written.
    """
    cameras = {
        name: {
            "world_from_camera": placed.world_from_camera.tolist(),
            "reprojection_px": round(placed.error, 4),
            "position_std_m": round(placed.std, 6),
        }
        for name, placed in placements.items()
    }
    told = {"format": FORMAT, "board": board.model_dump(), "cameras": cameras}
    try:
        Path(path).write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error


def read_places(path: str | Path) -> dict[str, Array]:
    """Return ``world_from_camera``, shape (4, 4), of each camera in a file.

    Raises
    ------
    CameraError
        If the file is missing, or does not hold rigid transforms.
    """
    try:
        told = json.loads(Path(path).read_text(encoding="utf-8"))
        if told["format"] != FORMAT:
            raise ValueError(f"format must be {FORMAT!r}")
        places = {
            str(name): np.array(camera["world_from_camera"], np.float64).reshape(4, 4)
            for name, camera in told["cameras"].items()
        }
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no calibration: {error!r}") from None
    for name, place in places.items():
        turn = place[:3, :3]
        rigid = np.allclose(turn @ turn.T, np.eye(3), atol=1e-5) and np.linalg.det(turn) > 0
        if not np.isfinite(place).all() or not rigid or place[3].tolist() != [0, 0, 0, 1]:
            raise CameraError(f"{path}: world_from_camera of {name} is no rigid transform")
    return places
