"""A board of AprilTags to calibrate cameras with: its geometry, its picture, its corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from igrip.perception.opencv import load_opencv
from igrip.perception.tag_detector import TagDetector
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

FAMILY = "tag36h11"
CELLS = 8  # across a tag, black border and all
MARGIN = 0.018  # m of white round the board on its page


class Board(Settings):
    """Rows of tags; the first, at the top left, has the number ``first``.

    The world it spans: origin in the middle of the board, x to its right, y to its top, z out of
    the paper, so up when it lies on a table.
    """

    columns: int = quantity(5, "1", "tags in a row", "fits A4", ge=1, le=20)
    rows: int = quantity(3, "1", "rows", "fits A4", ge=1, le=20)
    tag_size: float = quantity(
        0.045, "m", "of a tag from black edge to black edge, as measured on paper", "fits A4", gt=0
    )
    gap: float = quantity(0.2, "1", "between two tags, in sizes of a tag", "guess", gt=0, le=2)
    first: int = quantity(0, "1", "number of the first tag", "", ge=0, le=500)

    @property
    def pitch(self) -> float:
        """From one tag to the next [m]."""
        return self.tag_size * (1.0 + self.gap)

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of all tags together [m]."""
        return (
            self.columns * self.pitch - self.gap * self.tag_size,
            self.rows * self.pitch - self.gap * self.tag_size,
        )

    @property
    def ids(self) -> range:
        """The numbers of its tags."""
        return range(self.first, self.first + self.columns * self.rows)

    def corners(self, id: int) -> Array:
        """Return the corners of a tag in the world, shape (4, 3) [m].

        Top right, top left, bottom left, bottom right: the detector's order for tags that are
        printed as OpenCV draws them (:class:`igrip.perception.tag_detector.TagDetection`).
        """
        row, column = divmod(id - self.first, self.columns)
        width, height = self.extent
        left = column * self.pitch - width / 2
        top = height / 2 - row * self.pitch
        right, bottom = left + self.tag_size, top - self.tag_size
        return np.array([[right, top, 0], [left, top, 0], [left, bottom, 0], [right, bottom, 0]])

    def svg(self) -> str:
        """Return its picture at its true size, to be printed without scaling."""
        width, height = (1000 * (length + 2 * MARGIN) for length in self.extent)
        cell = 1000 * self.tag_size / CELLS
        squares = []
        for id in self.ids:
            corner = self.corners(id)[1]  # top left
            x0 = 1000 * (corner[0] + self.extent[0] / 2 + MARGIN)
            y0 = 1000 * (self.extent[1] / 2 - corner[1] + MARGIN)
            size = 1000 * self.tag_size
            squares.append(_square(x0, y0, size, size, "black"))
            for j, i in np.argwhere(pattern(id) > 0):
                squares.append(_square(x0 + i * cell, y0 + j * cell, cell, cell, "white"))
        caption = (
            f"igrip board: {self.columns} × {self.rows} {FAMILY}, tags of "
            f"{1000 * self.tag_size:g} mm; print at 100 % and measure a black square"
        )
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.2f}mm" '
            f'height="{height:.2f}mm" viewBox="0 0 {width:.2f} {height:.2f}" '
            f'shape-rendering="crispEdges">\n{_square(0, 0, width, height, "white")}\n'
            + "\n".join(squares)
            + f'\n<text x="{width / 2:.2f}" y="{height - 6:.2f}" font-size="4" '
            f'text-anchor="middle" font-family="sans-serif">{caption}</text>\n</svg>\n'
        )


def _square(x: float, y: float, width: float, height: float, colour: str) -> str:
    return (
        f'<rect x="{x:.3f}" y="{y:.3f}" width="{width:.3f}" height="{height:.3f}" fill="{colour}"/>'
    )


def pattern(id: int, cell: int = 1) -> NDArray[np.uint8]:
    """Return the picture of a tag, each of its 8 × 8 cells so many pixels wide; 0 is black."""
    cv2 = load_opencv("drawing tags")
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    return np.asarray(cv2.aruco.generateImageMarker(dictionary, id, CELLS * cell))


class BoardDetector:
    """Finds the corners of a board's tags in pictures."""

    def __init__(self, board: Board) -> None:
        self._ids = board.ids
        self._detector = TagDetector(FAMILY, decimate=1.0)

    def detect(self, frame: RgbdFrame) -> dict[int, Array]:
        """Return the corners of each tag, shape (4, 2), in the order of the board's [pixels]."""
        return {tag.id: tag.corners for tag in self._detector.detect(frame) if tag.id in self._ids}
