"""Square tiles of a picture, upright or turned, with known hands painted over.

The palm network sees any picture at 192 × 192 pixels: on a wide picture a hand can be too small for
it, and of two clasped hands it may take the second for a repeat of the first. A square part of the
picture, without the hand that is known, lets it detect what it missed.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.perception.hands import PALM, HandDetection, palm_length
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Array, Intrinsics

MAX_SIDE = 512  # pixels of a tile: the landmark network sees a hand at 224
TURNS = (60.0, 150.0, 240.0, 330.0, 0.0)  # it is not alike in all directions; docs/hands.md
HAND_SIDE = 5.5  # of a tile round one hand, in lengths of its palm; docs/hands.md
FOREARM = 1.0  # is covered so far beyond the wrist, in lengths of a palm; docs/hands.md
STUMP = (
    0.8  # a detection nearer to a covered wrist is its stump, in lengths of its palm; docs/hands.md
)
ARM_COSINE = 0.7  # of half the angle of the wedge in which the arm lies; docs/hands.md
ARM_LENGTH = 4.0  # in lengths of a palm; guess
SAME = 0.5  # detections nearer than this are of one hand, in lengths of a palm; guess
FLESH = 0.15  # reaches so far beyond the landmarks, in lengths of a palm; docs/hands.md


class Tile(NamedTuple):
    """A square part of a picture."""

    x: float  # of its centre [pixels]
    y: float
    side: float  # [pixels of the picture]
    turn: float = 0.0  # by which it is turned [degrees]

    def holds(self, landmarks: Array) -> bool:
        """Whether a hand, (21, 2) landmarks, is well inside."""
        away = np.linalg.norm(landmarks[list(PALM)].mean(axis=0) - [self.x, self.y])
        return bool(away < 0.3 * self.side)

    def render(
        self, picture: NDArray[np.uint8], hidden: list[HandDetection]
    ) -> tuple[NDArray[np.uint8], Array]:
        """Return the tile's pixels and the (2, 3) matrix that maps them to the picture's.

        ``picture`` (h, w, 3) is the whole picture; ``hidden`` are hands that are painted over.
        """
        cv2 = load_opencv("detecting hands")
        size = int(min(self.side, MAX_SIDE))
        half = 0.5 * (size - 1)
        c, s = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
        linear = self.side / size * np.array([[c, -s], [s, c]])
        offset = np.array([self.x, self.y]) - linear @ [half, half]
        back = np.column_stack([linear, offset])
        pixels: Any = cv2.warpAffine(
            picture, back, (size, size),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE,
        )  # fmt: skip
        inside = [(hand.landmarks - offset) @ np.linalg.inv(linear).T for hand in hidden]
        return paint_over(pixels, inside), back


def upright_tiles(intrinsics: Intrinsics) -> list[Tile]:
    """Return upright square tiles that cover a picture, half overlapping."""
    width, height = intrinsics.width, intrinsics.height
    side = float(min(width, height))
    steps = round(2 * (max(width, height) / side - 1)) + 1
    centres = np.linspace(0.5 * side, max(width, height) - 0.5 * side, steps).tolist()
    if width >= height:
        return [Tile(at, 0.5 * side, side) for at in centres]
    return [Tile(0.5 * side, at, side) for at in centres]


def search_tiles(intrinsics: Intrinsics, hands: list[HandDetection]) -> list[Tile]:
    """Return where to look for a missed hand: beside the known ones, and everywhere."""
    beside = [tile_around(hand.landmarks, turn) for turn in TURNS for hand in hands]
    mixed = itertools.zip_longest(beside, upright_tiles(intrinsics))
    return [tile for pair in mixed for tile in pair if tile is not None]


def tile_around(landmarks: Array, turn: float) -> Tile:
    """Return a tile round one hand, with room to move."""
    x, y = landmarks[list(PALM)].mean(axis=0)
    return Tile(float(x), float(y), HAND_SIDE * max(palm_length(landmarks), 16.0), turn)


def same_hand(one: Array, other: Array) -> bool:
    """Whether two detections, (21, 2) landmarks, are of one hand: wrist and palm agree."""
    reach = SAME * max(palm_length(one), palm_length(other))
    palms = np.linalg.norm((one - other)[list(PALM)].mean(axis=0))
    return bool(palms < reach and np.linalg.norm(one[0] - other[0]) < reach)


def is_stump(landmarks: Array, covered: Array) -> bool:
    """Whether a detection, (21, 2), is what is left of a covered hand: an arm with a blunt end.

    It lies where the covered wrist is, or down the arm; the other of two clasped hands comes from
    elsewhere.
    """
    from_wrist = landmarks[list(PALM)].mean(axis=0) - covered[0]
    away = float(np.linalg.norm(from_wrist))
    if away < STUMP * palm_length(landmarks):
        return True
    forearm = covered[0] - covered[list(PALM)].mean(axis=0)
    along = from_wrist @ forearm / max(away * float(np.linalg.norm(forearm)), 1e-9)
    return bool(along > ARM_COSINE and away < ARM_LENGTH * palm_length(covered))


def distinct(hands: list[HandDetection]) -> list[HandDetection]:
    """Return the hands without repeats, of which the first is kept."""
    kept: list[HandDetection] = []
    for hand in hands:
        if not any(same_hand(hand.landmarks, known.landmarks) for known in kept):
            kept.append(hand)
    return kept


def paint_over(picture: NDArray[np.uint8], hands: list[Array]) -> NDArray[np.uint8]:
    """Return a picture with hands, (21, 2), painted over in the median colour round them."""
    cv2 = load_opencv("painting hands over")
    copy = picture.copy()
    for landmarks in hands:
        width = max(2, int(FLESH * palm_length(landmarks)))
        mask = np.zeros(picture.shape[:2], np.uint8)
        forearm = landmarks[0] - landmarks[list(PALM)].mean(axis=0)
        forearm *= FOREARM * palm_length(landmarks) / max(float(np.linalg.norm(forearm)), 1.0)
        outline = np.vstack([landmarks, landmarks[0] + forearm])
        hull = cv2.convexHull(np.round(outline).astype(np.int32))
        cv2.fillConvexPoly(mask, hull, 1)
        cv2.polylines(mask, [hull], True, 1, 2 * width)
        ring = mask.copy()
        cv2.polylines(ring, [hull], True, 1, 4 * width)
        beside = picture[(ring == 1) & (mask == 0)]
        if len(beside):
            copy[mask == 1] = np.median(beside, axis=0)
    return copy
