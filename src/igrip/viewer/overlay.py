"""Hands, objects and intentions drawn over the camera's picture (paper: Figure 4A)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.describe import describe, headline
from igrip.errors import requires_extra
from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.perception.hands import LANDMARKS, palm_pixel
from igrip.rgbd import RgbdFrame
from igrip.viewer.palette import INK, PAPER, colour_of, letter_of, rgb

Array = NDArray[np.float64]
Colour = tuple[int, int, int]
BONES = (
    (0, 1), (1, 2), (2, 3), (3, 4), (0, 5), (5, 6), (6, 7), (7, 8), (5, 9), (9, 10), (10, 11),
    (11, 12), (9, 13), (13, 14), (14, 15), (15, 16), (13, 17), (17, 18), (18, 19), (19, 20),
    (0, 17),
)  # fmt: skip
DARK, LIGHT = rgb(INK), rgb(PAPER)
MIN_DEPTH = 0.05  # m; nearer objects have no outline


class CameraView(NamedTuple):
    """What is drawn over a frame.

    Attributes
    ----------
    landmarks : mapping of str to (21, 2) or (n, 2)
        Of each hand [pixels]; see :class:`igrip.perception.hands.HandDetection`.
    objects : sequence of PlacedObject
        In the world frame.
    intentions : sequence of Intention
        The newest of each hand.
    """

    frame: RgbdFrame
    landmarks: Mapping[str, Array]
    objects: Sequence[PlacedObject]
    intentions: Sequence[Intention]


def draw_overlay(
    view: CameraView, width: int = 640, looks: Mapping[str, int] | None = None
) -> NDArray[np.uint8]:
    """Return a frame's colour picture with landmarks, outlines, targets and grips drawn over it.

    Each object has the colour and letter of its number in ``looks``, by default that of its place
    among the names. A target has a thick dark outline around its own. The shape is (h, width, 3),
    red, green, blue.

    Raises
    ------
    MissingExtraError
        If OpenCV is not installed.
    """
    frame, landmarks, objects, intentions = view
    with requires_extra("opencv-python-headless", "hands", "the overlay"):
        import cv2
    scale = width / frame.intrinsics.width
    size = (width, max(1, round(scale * frame.intrinsics.height)))
    picture = cv2.resize(frame.colour, size, interpolation=cv2.INTER_AREA)
    labels: list[_Label] = []
    targets = {headline(intention).target for intention in intentions}
    if looks is None:
        looks = {id: k for k, id in enumerate(sorted(placed.id for placed in objects))}
    for placed in objects:
        outline = outline_of(frame, placed)
        if outline is None:
            continue
        number = looks.get(placed.id, 0)
        corners = np.round(scale * outline).astype(np.int32)
        if placed.id in targets:
            cv2.polylines(picture, [corners], True, DARK, 11, cv2.LINE_AA)
            cv2.polylines(picture, [corners], True, LIGHT, 7, cv2.LINE_AA)
        cv2.polylines(picture, [corners], True, rgb(colour_of(number)), 3, cv2.LINE_AA)
        name = f"{letter_of(number)} {placed.id}"
        top = corners[np.argmin(corners[:, 1])] - [0, 6]
        labels.append(_Label(name, top, DARK, LIGHT, rgb(colour_of(number))))
    by_hand = {intention.hand: intention for intention in intentions}
    for id, points in landmarks.items():
        palm = _draw_hand(cv2, picture, scale * points)
        intention = by_hand.get(id)
        said = f"{id} hand" if intention is None else describe(intention)
        labels.insert(0, _Label(said, palm + [10, -10], LIGHT, DARK, LIGHT))
    _write(cv2, picture, labels)  # over everything; what a hand does has the place it wants
    drawn: NDArray[np.uint8] = picture
    return drawn


def outline_of(frame: RgbdFrame, placed: PlacedObject) -> Array | None:
    """Return the convex outline of an object in the picture, (n, 2) pixels.

    None if it is not wholly in front of the camera, or outside the picture.
    """
    from scipy.spatial import ConvexHull, QhullError

    world = placed.model.vertices @ placed.rotation.T + placed.translation
    camera = np.linalg.inv(frame.world_from_camera)
    points = world @ camera[:3, :3].T + camera[:3, 3]
    if points[:, 2].min() < MIN_DEPTH:
        return None
    pixels = frame.intrinsics.pixels(points)
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    size = np.array([frame.intrinsics.width, frame.intrinsics.height])
    if (high < 0.0).any() or (low > size).any():
        return None
    try:
        return np.asarray(pixels[ConvexHull(pixels).vertices])
    except QhullError:  # edge on, or a single pixel
        return None


def _draw_hand(cv2: Any, picture: NDArray[np.uint8], points: Array) -> NDArray[Any]:
    """Draw landmarks and palm; return the pixel of the palm.

    Of a hand without landmarks, the palm alone.
    """
    corners = np.round(points).astype(int).tolist()
    with_bones = len(corners) == LANDMARKS
    for colour, width in ((LIGHT, 5), (DARK, 2)):
        for a, b in BONES if with_bones else ():
            cv2.line(picture, corners[a], corners[b], colour, width, cv2.LINE_AA)
    for corner in corners if with_bones else corners[:0]:
        cv2.circle(picture, corner, 4, DARK, -1, cv2.LINE_AA)
        cv2.circle(picture, corner, 3, LIGHT, -1, cv2.LINE_AA)
    palm: NDArray[Any] = np.round(palm_pixel(points)).astype(int)
    cv2.circle(picture, palm.tolist(), 7, DARK, -1, cv2.LINE_AA)
    return palm


class _Label(NamedTuple):
    text: str
    at: NDArray[Any]  # lower left corner of the text [pixels]
    ink: Colour
    paper: Colour
    border: Colour


class Box(NamedTuple):
    """A rectangle of pixels; its ends are not part of it."""

    left: int
    top: int
    right: int
    bottom: int

    def overlaps(self, other: Box) -> bool:
        """Whether two rectangles share a pixel."""
        across = self.left < other.right and other.left < self.right
        return across and self.top < other.bottom and other.top < self.bottom


def place_boxes(boxes: Sequence[Box], width: int, height: int) -> list[Box]:
    """Move rectangles into a picture, and each above or below earlier ones that it would cover.

    One that finds no room stays where it covers others.
    """
    placed: list[Box] = []
    for wanted in boxes:
        wide, high = wanted.right - wanted.left, wanted.bottom - wanted.top
        left = max(0, min(wanted.left, width - wide))
        first = max(0, min(wanted.top, height - high))
        tops = [first, *(t for box in placed for t in (box.top - high, box.bottom))]
        tops = [top for top in tops if 0 <= top <= height - high] or [first]
        found = [Box(left, top, left + wide, top + high) for top in tops]
        free = [box for box in found if not any(map(box.overlaps, placed))] or found
        placed.append(min(free, key=lambda box: abs(box.top - first)))
    return placed


def _write(cv2: Any, picture: NDArray[np.uint8], labels: Sequence[_Label]) -> None:
    """Write lines inside the picture, each on a background of its own."""
    font, size, margin = cv2.FONT_HERSHEY_SIMPLEX, 0.55, 4
    height, width = picture.shape[:2]
    texts, boxes = [], []
    for label in labels:
        text = label.text.encode("ascii", "replace").decode()
        while (wide := cv2.getTextSize(text, font, size, 1)[0][0]) > width - 2 * margin:
            text = text[: min(len(text) - 4, len(text) * width // wide)] + "..."
        (wide, high), below = cv2.getTextSize(text, font, size, 1)
        x, y = label.at.tolist()
        texts.append(text)
        boxes.append(Box(x - margin, y - high - margin, x + wide + margin, y + below + margin))
    for label, text, box in zip(labels, texts, place_boxes(boxes, width, height), strict=True):
        below = cv2.getTextSize(text, font, size, 1)[1]
        cv2.rectangle(picture, box[:2], (box.right - 1, box.bottom - 1), label.paper, -1)
        cv2.rectangle(picture, box[:2], (box.right - 1, box.bottom - 1), label.border, 2)
        foot = (box.left + margin, box.bottom - below - margin)
        cv2.putText(picture, text, foot, font, size, label.ink, 1, cv2.LINE_AA)
