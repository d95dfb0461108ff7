"""Square views of a picture, upright or turned, and hands covered up in it.

The palm network sees any picture at 192 × 192 pixels: on a wide picture a hand can be too small for
it, and of two clasped hands it may take the second for the first seen twice. A square part of the
picture, and the picture without the hand that is known, let it see what it missed.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.perception.hands import HandDetection
from igrip.rgbd import Intrinsics

Array = NDArray[np.float64]

SIDE = 512  # pixels of a view at most: the landmark network sees a hand at 224
TURNS = (60.0, 150.0, 240.0, 330.0, 0.0)  # it is not alike in all directions; docs/hands.md
AROUND = 5.5  # side of a view round one hand, in lengths of its palm; docs/hands.md
PALM = (0, 5, 17)
FOREARM = 1.0  # lengths of a palm that are covered beyond the wrist; docs/hands.md
STUMP = 0.8  # lengths of its palm from the wrist of a covered hand, at least; docs/hands.md
DOWN = 0.7  # cosine of half the angle of the wedge in which the arm lies; docs/hands.md
ARM = 4.0  # lengths of a palm that an arm goes on for; guess
SAME = 0.5  # lengths of a palm between two finds of one hand, at most; guess
GROWN = 0.15  # lengths of a palm that flesh reaches beyond the landmarks; docs/hands.md


class View(NamedTuple):
    """A square part of a picture.

    Attributes
    ----------
    x, y : float
        Its centre [pixels].
    side : float
        [pixels of the picture].
    turn : float
        By which it is turned [degrees].
    """

    x: float
    y: float
    side: float
    turn: float = 0.0

    def holds(self, landmarks: Array) -> bool:
        """Whether a hand, (21, 2) landmarks, is well inside."""
        away = np.linalg.norm(landmarks[list(PALM)].mean(axis=0) - [self.x, self.y])
        return bool(away < 0.3 * self.side)

    def render(
        self, picture: NDArray[np.uint8], hidden: list[HandDetection]
    ) -> tuple[NDArray[np.uint8], Array]:
        """Return the view and the (2, 3) matrix that takes its pixels to the picture's.

        Parameters
        ----------
        picture : (h, w, 3) uint8
            The whole picture.
        hidden : list of HandDetection
            Hands of the picture that are covered up in the view.
        """
        import cv2

        size = int(min(self.side, SIDE))
        half = 0.5 * (size - 1)
        c, s = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
        linear = self.side / size * np.array([[c, -s], [s, c]])
        offset = np.array([self.x, self.y]) - linear @ [half, half]
        back = np.column_stack([linear, offset])
        seen: Any = cv2.warpAffine(
            picture, back, (size, size),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE,
        )  # fmt: skip
        inside = [(hand.landmarks - offset) @ np.linalg.inv(linear).T for hand in hidden]
        return covered(seen, inside), back


def tiles(intrinsics: Intrinsics) -> list[View]:
    """Return upright square views that cover a picture, half overlapping."""
    width, height = intrinsics.width, intrinsics.height
    side = float(min(width, height))
    steps = round(2 * (max(width, height) / side - 1)) + 1
    centres = np.linspace(0.5 * side, max(width, height) - 0.5 * side, steps).tolist()
    if width >= height:
        return [View(at, 0.5 * side, side) for at in centres]
    return [View(0.5 * side, at, side) for at in centres]


def search_views(intrinsics: Intrinsics, hands: list[HandDetection]) -> list[View]:
    """Return where to look for a hand that is missed: beside the known ones, and everywhere."""
    beside = [around(hand.landmarks, turn) for turn in TURNS for hand in hands]
    mixed = itertools.zip_longest(beside, tiles(intrinsics))
    return [view for pair in mixed for view in pair if view is not None]


def palm_length(landmarks: Array) -> float:
    """Return how long the palm of (21, 2) landmarks appears: wrist to knuckles [pixels]."""
    wrist, index, little = landmarks[list(PALM)]
    # a palm seen edge on is as broad as ever in one direction at least
    return float(
        max(np.linalg.norm(0.5 * (index + little) - wrist), np.linalg.norm(index - little))
    )


def around(landmarks: Array, turn: float) -> View:
    """Return a view of one hand, with room to move."""
    x, y = landmarks[list(PALM)].mean(axis=0)
    return View(float(x), float(y), AROUND * max(palm_length(landmarks), 16.0), turn)


def same_hand(one: Array, other: Array) -> bool:
    """Whether two finds, (21, 2) landmarks, are of one hand: wrist and palm at one place."""
    reach = SAME * max(palm_length(one), palm_length(other))
    palms = np.linalg.norm((one - other)[list(PALM)].mean(axis=0))
    return bool(palms < reach and np.linalg.norm(one[0] - other[0]) < reach)


def is_stump(find: Array, known: Array) -> bool:
    """Whether a find, (21, 2), is what is left of a covered hand: an arm that ends in a blob.

    It lies where the covered wrist is, or down the arm; the other of two clasped hands comes from
    elsewhere.
    """
    from_wrist = find[list(PALM)].mean(axis=0) - known[0]
    away = float(np.linalg.norm(from_wrist))
    if away < STUMP * palm_length(find):
        return True
    forearm = known[0] - known[list(PALM)].mean(axis=0)
    along = from_wrist @ forearm / max(away * float(np.linalg.norm(forearm)), 1e-9)
    return bool(along > DOWN and away < ARM * palm_length(known))


def distinct(hands: list[HandDetection]) -> list[HandDetection]:
    """Return the hands without repeats, of which the first is kept."""
    kept: list[HandDetection] = []
    for hand in hands:
        if not any(same_hand(hand.landmarks, known.landmarks) for known in kept):
            kept.append(hand)
    return kept


def covered(picture: NDArray[np.uint8], hands: list[Array]) -> NDArray[np.uint8]:
    """Return a picture with hands, (21, 2), painted over in the commonest colour round them."""
    import cv2

    copy = picture.copy()
    for landmarks in hands:
        grown = max(2, int(GROWN * palm_length(landmarks)))
        mask = np.zeros(picture.shape[:2], np.uint8)
        forearm = landmarks[0] - landmarks[list(PALM)].mean(axis=0)
        forearm *= FOREARM * palm_length(landmarks) / max(float(np.linalg.norm(forearm)), 1.0)
        outline = np.vstack([landmarks, landmarks[0] + forearm])
        hull = cv2.convexHull(np.round(outline).astype(np.int32))
        cv2.fillConvexPoly(mask, hull, 1)
        cv2.polylines(mask, [hull], True, 1, 2 * grown)
        ring = mask.copy()
        cv2.polylines(ring, [hull], True, 1, 4 * grown)
        beside = picture[(ring == 1) & (mask == 0)]
        if len(beside):
            copy[mask == 1] = np.median(beside, axis=0)
    return copy
