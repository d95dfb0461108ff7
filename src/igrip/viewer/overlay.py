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
from igrip.perception.hands import PALM
from igrip.rgbd import RgbdFrame
from igrip.viewer.palette import INK, PAPER, colour_of, letter_of, rgb

Array = NDArray[np.float64]
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
    landmarks : mapping of str to (21, 2)
        Of each hand [pixels].
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
        _write(cv2, picture, name, top, rgb(colour_of(number)), LIGHT)
    by_hand = {intention.hand: intention for intention in intentions}
    for id, points in landmarks.items():
        _draw_hand(cv2, picture, id, scale * points, by_hand.get(id))
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


def _draw_hand(
    cv2: Any, picture: NDArray[np.uint8], id: str, points: Array, intention: Intention | None
) -> None:
    corners = np.round(points).astype(int).tolist()
    for colour, width in ((LIGHT, 5), (DARK, 2)):
        for a, b in BONES:
            cv2.line(picture, corners[a], corners[b], colour, width, cv2.LINE_AA)
    for corner in corners:
        cv2.circle(picture, corner, 4, DARK, -1, cv2.LINE_AA)
        cv2.circle(picture, corner, 3, LIGHT, -1, cv2.LINE_AA)
    palm = np.round(points[list(PALM)].mean(axis=0)).astype(int)
    cv2.circle(picture, palm.tolist(), 7, DARK, -1, cv2.LINE_AA)
    label = f"{id} hand" if intention is None else describe(intention)
    _write(cv2, picture, label, palm + [10, -10], LIGHT, DARK)


def _write(
    cv2: Any, picture: NDArray[np.uint8], text: str, at: Array, ink: tuple[int, int, int],
    paper: tuple[int, int, int],
) -> None:  # fmt: skip
    """Write a line inside the picture, on a background."""
    text = text.encode("ascii", "replace").decode()[:90]
    font, size = cv2.FONT_HERSHEY_SIMPLEX, 0.55
    (wide, high), below = cv2.getTextSize(text, font, size, 1)
    x = int(np.clip(at[0], 0, max(0, picture.shape[1] - wide)))
    y = int(np.clip(at[1], high, picture.shape[0] - below))
    cv2.rectangle(picture, (x, y - high - 2), (x + wide, y + below), paper, -1)
    cv2.putText(picture, text, (x, y), font, size, ink, 1, cv2.LINE_AA)
