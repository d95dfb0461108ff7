"""Where cameras stand, from a board of tags that all of them see."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from igrip.errors import CameraError
from igrip.perception.calibration.board import Board, BoardDetector
from igrip.perception.opencv import load_opencv
from igrip.perception.placements import Placement
from igrip.perception.transforms import rigid
from igrip.rgbd import Array, Intrinsics, RgbdFrame
from igrip.settings import Settings, quantity


class CalibrationConfig(Settings):
    """How many tags and pictures are needed, and how well they must fit."""

    max_views: int = quantity(30, "1", "pictures of each camera that are used", "guess", ge=1)
    min_tags: int = quantity(4, "1", "tags that must be in the picture", "guess", ge=2)
    max_error: float = quantity(1.0, "pixels", "reprojection error, root mean square", "guess")
    max_motion: float = quantity(1.5, "pixels", "by which a corner may move", "guess")
    outlier: float = quantity(0.5, "pixels", "errors beyond this count less (soft L1)", "guess")
    min_ratio: float = quantity(
        1.2, "1", "the mirrored pose must fit worse than the best by this factor", "guess", ge=1
    )


class BoardViews:
    """The corners of the board in one camera's pictures and, with depth, how far they are."""

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.intrinsics = intrinsics  # of all pictures
        self.corners: list[Mapping[int, Array]] = []  # of each picture, (4, 2) by tag [pixels]
        self.depths: list[Mapping[int, float]] = []  # of each picture with depth, by tag [m]

    def add(self, frame: RgbdFrame, corners: Mapping[int, Array]) -> None:
        """Add one picture, with the corners that were detected in it."""
        self.corners.append(corners)
        if frame.depth is None:
            return
        depths: dict[int, float] = {}
        for id, four in corners.items():
            u, v = np.round(four.mean(axis=0)).astype(int)
            part = frame.depth[max(0, v - 2) : v + 3, max(0, u - 2) : u + 3]
            if (part > 0).any():
                depths[id] = float(np.median(part[part > 0]))
        self.depths.append(depths)


def watch_board(
    frames: Iterable[RgbdFrame],
    board: Board,
    seconds: float = 5.0,
    cameras: int = 1,
    config: CalibrationConfig | None = None,
) -> dict[str, BoardViews]:
    """Detect the board in the frames of all cameras; return the views by camera.

    It ends after ``seconds`` of the frames' own time, or once so many cameras have given as many
    pictures as are used.
    """
    config = config or CalibrationConfig()
    detector = BoardDetector(board)
    views: dict[str, BoardViews] = {}
    first: float | None = None
    for frame in frames:
        first = frame.t if first is None else first
        own = views.setdefault(frame.camera, BoardViews(frame.intrinsics))
        if own.intrinsics != frame.intrinsics:
            raise CameraError(f"the intrinsics of {frame.camera} change while it is calibrated")
        if len(own.corners) < config.max_views:
            own.add(frame, detector.detect(frame))
        enough = all(len(one.corners) >= config.max_views for one in views.values())
        if frame.t - first >= seconds or (enough and len(views) >= cameras):
            break
    return views


def locate_camera(
    name: str, views: BoardViews, board: Board, config: CalibrationConfig | None = None
) -> Placement:
    """Return where a camera stands.

    Each corner is the median of those in all pictures; the pose is the least-squares fit of all
    corners (soft L1), begun from both solutions of a plane's pose (Collins & Bartoli 2014, IPPE).

    Raises
    ------
    CameraError
        If too few tags are visible, something moved, or the fit is poor; the message says what to
        do.
    """
    config = config or CalibrationConfig()
    corners = _median_corners(name, views, board, config)
    fits = [corners.fit(start, config.outlier) for start in corners.initial_poses()]
    fits.sort(key=lambda fit: float(fit.cost))
    best = fits[0]
    distances = np.linalg.norm(corners.residuals(best.x).reshape(-1, 2), axis=1)
    error = float(np.sqrt(np.mean(distances**2)))
    if error > config.max_error:
        raise CameraError(
            f"{name}: corners lie {error:.2f} pixels from where they should (at most "
            f"{config.max_error:g}): is the board flat and printed as it is described, and is the "
            "camera's lens calibrated?"
        )
    for other in fits[1:]:
        turned = Rotation.from_rotvec(best.x[:3]) * Rotation.from_rotvec(other.x[:3]).inv()
        if turned.magnitude() > 0.02 and other.cost < config.min_ratio**2 * best.cost:
            raise CameraError(
                f"{name}: two poses fit the board equally well: bring it nearer, or look at it "
                "from further aside"
            )
    camera_from_world = rigid(Rotation.from_rotvec(best.x[:3]).as_matrix(), best.x[3:])
    covariance = np.linalg.pinv(best.jac.T @ best.jac) * error**2 / 2
    std = float(np.sqrt(np.trace(covariance[3:, 3:])))
    return Placement(
        np.asarray(np.linalg.inv(camera_from_world), np.float64), error, std, len(corners.ids),
        len(views.corners), _depth_ratio(views, camera_from_world, board),
    )  # fmt: skip


class _Corners(NamedTuple):
    """Corners in a picture and on the board, and the pose that explains them.

    A pose is a rotation vector and a translation, (6,), camera from world: what the solver varies.
    """

    pixels: Array  # (n, 2)
    points: Array  # (n, 3) [m]
    ids: Sequence[int]
    intrinsics: Intrinsics

    def initial_poses(self) -> list[Array]:
        """Return both poses of a plane that look like this."""
        cv2 = load_opencv("calibration")
        solution = cv2.solvePnPGeneric(
            self.points, self.pixels, self.intrinsics.matrix, None, flags=cv2.SOLVEPNP_IPPE
        )
        poses = [
            np.concatenate([rotation.ravel(), translation.ravel()])
            for rotation, translation in zip(solution[1], solution[2], strict=True)
        ]
        if not poses:
            raise CameraError("no pose of a camera explains these corners")
        return poses

    def residuals(self, pose: Array) -> Array:
        """Return by how much corners are off, (2 n,) [pixels]."""
        points = Rotation.from_rotvec(pose[:3]).apply(self.points) + pose[3:]
        residuals: Array = (self.intrinsics.pixels(points) - self.pixels).ravel()
        return residuals

    def fit(self, start: Array, outlier: float) -> Any:
        """Return scipy's result of the least-squares fit."""
        return least_squares(self.residuals, start, loss="soft_l1", f_scale=outlier, x_scale="jac")


def _median_corners(
    name: str, views: BoardViews, board: Board, config: CalibrationConfig
) -> _Corners:
    """Return the corners of the tags that are in half of the pictures, their medians over time."""
    pixels, points, ids, motion = [], [], [], []
    for id in board.ids:
        detected = np.array([corners[id] for corners in views.corners if id in corners])
        if len(detected) >= max(1, len(views.corners) // 2):
            median = np.median(detected, axis=0)
            motion.append(np.percentile(np.linalg.norm(detected - median, axis=2), 90))
            pixels.append(median)
            points.append(board.corners(id))
            ids.append(id)
    if len(ids) < config.min_tags:
        raise CameraError(
            f"{name}: sees {len(ids)} tags of the board, {config.min_tags} are needed: is it in "
            "the picture, flat, near and well lit?"
        )
    if np.median(motion) > config.max_motion:
        raise CameraError(f"{name}: the board or the camera moved; let both rest")
    return _Corners(np.concatenate(pixels), np.concatenate(points), ids, views.intrinsics)


def _depth_ratio(views: BoardViews, camera_from_world: Array, board: Board) -> float | None:
    ratios = []
    for depths in views.depths:
        for id, depth in depths.items():
            centre = np.append(board.corners(id).mean(axis=0), 1.0)
            ratios.append(depth / float(camera_from_world[2] @ centre))
    return float(np.median(ratios)) if ratios else None
