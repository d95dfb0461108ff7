"""Extrinsics from a board: pictures made at known places give those places back."""

import json

import numpy as np
import pytest

from board_pictures import CAMERA, looking_at, see
from igrip.perception.calibration.board import Board, CornerFinder
from igrip.perception.calibration.extrinsics import (
    CalibrationConfig,
    collect,
    place_camera,
    read_places,
    write_calibration,
)
from igrip.perception.cameras import CameraError

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
    views = collect(frames(4, PLACES, depth=True), BOARD, cameras=2)
    assert set(views) == set(PLACES)
    for name, seen in views.items():
        placed = place_camera(name, seen, BOARD)
        metres, radians = away(placed.world_from_camera, PLACES[name])
        assert metres < 0.001
        assert radians < np.radians(0.1)
        assert placed.error < 0.2
        assert metres < 6 * placed.std + 0.0003
        assert placed.tags == 15
        assert placed.views == 4
        assert placed.depth_ratio == pytest.approx(1.0, abs=0.003)


def test_corners_are_where_they_are():
    pose = PLACES["left"]
    found = CornerFinder(BOARD).find(see(BOARD, pose, noise=1.0))
    assert set(found) == set(BOARD.ids)
    there = np.linalg.inv(pose)
    for id, corners in found.items():
        points = BOARD.corners(id) @ there[:3, :3].T + there[:3, 3]
        assert np.abs(CAMERA.pixels(points) - corners).max() < 0.35


def test_the_board_may_be_partly_hidden():
    def hidden():
        for frame in frames(4):
            frame.colour[:, 700:] = 90
            yield frame

    views = collect(hidden(), BOARD)
    placed = place_camera("left", views["left"], BOARD)
    assert 4 <= placed.tags < 15
    assert away(placed.world_from_camera, PLACES["left"])[0] < 0.003


def test_outliers_in_some_pictures_do_not_matter():
    views = collect(frames(5), BOARD)["left"]
    for corners in views.corners[:2]:
        for four in corners.values():
            four += 40.0
    config = CalibrationConfig(still=100.0)
    placed = place_camera("left", views, BOARD, config)
    assert away(placed.world_from_camera, PLACES["left"])[0] < 0.001


def test_a_wrong_lens_is_noticed():
    views = collect(frames(2), BOARD)["left"]
    views.intrinsics = CAMERA._replace(fx=700.0)
    with pytest.raises(CameraError, match=r"left: corners lie .* is the board flat"):
        place_camera("left", views, BOARD)


def test_a_board_that_moves_is_noticed():
    def moving():
        for k in range(6):
            pose = looking_at(np.array([-0.35 + 0.01 * k, -0.45, 0.55]))
            yield see(BOARD, pose, k / 30, "left", seed=k)

    views = collect(moving(), BOARD)["left"]
    with pytest.raises(CameraError, match="moved; let both rest"):
        place_camera("left", views, BOARD)


def test_no_board():
    def empty():
        for frame in frames(1):
            frame.colour[:] = 90
            yield frame

    views = collect(empty(), BOARD)["left"]
    with pytest.raises(CameraError, match="sees 0 tags"):
        place_camera("left", views, BOARD)


def test_a_board_printed_too_small_shows_in_the_depth():
    said = Board(tag_size=0.05)  # on paper it has 45 mm
    views = collect(frames(2, depth=True), said)
    placed = place_camera("left", views["left"], said)
    assert placed.depth_ratio == pytest.approx(45 / 50, abs=0.005)


def test_seconds_are_those_of_the_frames():
    pictures = list(frames(2, PLACES))
    seen = collect(iter(pictures), BOARD, seconds=0.0)
    assert [len(v.corners) for v in seen.values()] == [1]


def test_a_file_comes_back(tmp_path):
    views = collect(frames(1, PLACES), BOARD, cameras=2)
    placements = {name: place_camera(name, seen, BOARD) for name, seen in views.items()}
    write_calibration(tmp_path / "c.json", placements, BOARD)
    places = read_places(tmp_path / "c.json")
    for name, place in places.items():
        assert np.array_equal(place, placements[name].world_from_camera)
    assert json.loads((tmp_path / "c.json").read_text())["board"]["columns"] == 5
    with pytest.raises(CameraError, match="nowhere"):
        write_calibration(tmp_path / "nowhere" / "c.json", placements, BOARD)


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "{}", '{"format": "other"}', '{"format": "igrip-calibration/1", "cameras": 3}',
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": [1, 2]}}}',
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": '
        "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}}}",
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": '
        "[[1,0,0,NaN],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}}",
    ],
)  # fmt: skip
def test_files_that_are_none(tmp_path, text):
    (tmp_path / "c.json").write_text(text)
    with pytest.raises(CameraError, match=r"c\.json"):
        read_places(tmp_path / "c.json")


def test_a_missing_file(tmp_path):
    with pytest.raises(CameraError, match="No such file"):
        read_places(tmp_path / "c.json")


def test_the_printed_board_is_the_one_that_is_looked_for():
    """The SVG's squares, drawn, give the picture the other tests are made from."""
    import xml.etree.ElementTree as ElementTree

    from board_pictures import flat

    board = Board(columns=2, rows=2, tag_size=0.04)
    root = ElementTree.fromstring(board.svg())
    picture, _ = flat(board, cell=10)
    scale = 1 / (1000 * board.tag_size / 80)  # pixels a mm
    drawn = np.zeros(picture.shape)
    for square in root.iter("{http://www.w3.org/2000/svg}rect"):
        x, y, w, h = (float(square.get(key)) * scale for key in ("x", "y", "width", "height"))
        rows, columns = slice(round(y), round(y + h)), slice(round(x), round(x + w))
        drawn[rows, columns] = square.get("fill") == "white"
    assert np.mean(drawn != (picture > 128)) < 0.002
    assert root.get("width") == f"{1000 * (board.extent[0] + 0.036):.2f}mm"
