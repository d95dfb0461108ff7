"""Extrinsics from a board: pictures made at known places give those places back."""

import numpy as np
import pytest

from board_pictures import CAMERA, looking_at, see
from igrip.errors import CameraError
from igrip.perception.calibration.board import Board
from igrip.perception.calibration.extrinsics import CalibrationConfig, locate_camera, watch_board

BOARD = Board()
PLACES = {
    "left": looking_at(np.array([-0.35, -0.45, 0.55])),
    "right": looking_at(np.array([0.4, -0.3, 0.7]), (0.03, 0.02, 0.0)),
}


def away(found, true):
    """Return how far a pose is from the true one [m], and by what angle turned [rad]."""
    turn = found[:3, :3].T @ true[:3, :3]
    angle = np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))
    return np.linalg.norm(found[:3, 3] - true[:3, 3]), angle


def frames(views=6, names=("left",), **more):
    for k in range(views):
        for n, name in enumerate(names):
            pose = PLACES[name]
            yield see(BOARD, pose, k / 30, name, seed=10 * k + n, **more)


def test_two_cameras():
    views = watch_board(frames(4, PLACES, depth=True), BOARD, cameras=2)
    assert set(views) == set(PLACES)
    for name, view in views.items():
        placed = locate_camera(name, view, BOARD)
        metres, radians = away(placed.world_from_camera, PLACES[name])
        assert metres < 0.001
        assert radians < np.radians(0.1)
        assert placed.error < 0.2
        assert metres < 6 * placed.std + 0.0003
        assert placed.tags == 15
        assert placed.views == 4
        assert placed.depth_ratio == pytest.approx(1.0, abs=0.003)


def test_the_board_may_be_partly_hidden():
    def hidden():
        for frame in frames(4):
            frame.colour[:, 700:] = 90
            yield frame

    views = watch_board(hidden(), BOARD)
    placed = locate_camera("left", views["left"], BOARD)
    assert 4 <= placed.tags < 15
    assert away(placed.world_from_camera, PLACES["left"])[0] < 0.003


def test_outliers_in_some_pictures_do_not_matter():
    views = watch_board(frames(5), BOARD)["left"]
    for corners in views.corners[:2]:
        for four in corners.values():
            four += 40.0
    config = CalibrationConfig(max_motion=100.0)
    placed = locate_camera("left", views, BOARD, config)
    assert away(placed.world_from_camera, PLACES["left"])[0] < 0.001


def test_a_wrong_lens_is_noticed():
    views = watch_board(frames(2), BOARD)["left"]
    views.intrinsics = CAMERA._replace(fx=700.0)
    with pytest.raises(CameraError, match=r"left: corners lie .* is the board flat"):
        locate_camera("left", views, BOARD)


def test_a_board_that_moves_is_noticed():
    def moving():
        for k in range(6):
            pose = looking_at(np.array([-0.35 + 0.01 * k, -0.45, 0.55]))
            yield see(BOARD, pose, k / 30, "left", seed=k)

    views = watch_board(moving(), BOARD)["left"]
    with pytest.raises(CameraError, match="moved; let both rest"):
        locate_camera("left", views, BOARD)


def test_no_board():
    def empty():
        for frame in frames(1):
            frame.colour[:] = 90
            yield frame

    views = watch_board(empty(), BOARD)["left"]
    with pytest.raises(CameraError, match="sees 0 tags"):
        locate_camera("left", views, BOARD)


def test_a_board_printed_too_small_shows_in_the_depth():
    described = Board(tag_size=0.05)  # on paper it has 45 mm
    views = watch_board(frames(2, depth=True), described)
    placed = locate_camera("left", views["left"], described)
    assert placed.depth_ratio == pytest.approx(45 / 50, abs=0.005)


def test_seconds_are_those_of_the_frames():
    pictures = list(frames(2, PLACES))
    views = watch_board(iter(pictures), BOARD, seconds=0.0)
    assert [len(view.corners) for view in views.values()] == [1]
