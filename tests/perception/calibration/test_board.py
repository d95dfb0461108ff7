"""A board of tags: its picture, and its corners in pictures of it."""

import numpy as np

from board_pictures import CAMERA, looking_at, see
from igrip.perception.calibration.board import Board, BoardDetector

BOARD = Board()


def test_corners_are_where_they_are():
    pose = looking_at(np.array([-0.35, -0.45, 0.55]))
    found = BoardDetector(BOARD).detect(see(BOARD, pose, noise=1.0))
    assert set(found) == set(BOARD.ids)
    there = np.linalg.inv(pose)
    for id, corners in found.items():
        points = BOARD.corners(id) @ there[:3, :3].T + there[:3, 3]
        assert np.abs(CAMERA.pixels(points) - corners).max() < 0.35


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
