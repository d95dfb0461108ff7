"""Hands cut out of a film of a real hand, to be put into rendered frames."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.lab.rendering.drawn_hand import BONES, FINGER_WIDTH, FOREARM, PALM, Sprite, draw_line
from igrip.perception.hands import HandDetector, palm_length
from igrip.rgbd import Intrinsics, RgbdFrame

Array = NDArray[np.float64]


def cut_out(colour: NDArray[np.uint8], landmarks: Array) -> Sprite:
    """Cut a hand and a piece of its arm out of a picture.

    The landmarks' outline, grown, marks where skin surely and where it may be; GrabCut (Rother et
    al. 2004) decides between.
    """
    length = palm_length(landmarks)
    arm = landmarks[0] - landmarks[list(PALM)].mean(axis=0)
    reach = np.vstack([landmarks, landmarks[0] + FOREARM * arm])
    margin = 0.5 * length
    height, width = colour.shape[:2]
    low = np.maximum(np.floor(reach.min(axis=0) - margin), 0).astype(int)
    high = np.minimum(np.ceil(reach.max(axis=0) + margin), [width, height]).astype(int)
    if (high - low < 8).any():
        raise IgripError("the hand is outside the picture")
    part = np.ascontiguousarray(colour[low[1] : high[1], low[0] : high[0]])
    inside = landmarks - low
    mask = np.full(part.shape[:2], cv2.GC_BGD, np.uint8)
    hull = cv2.convexHull(np.round(reach - low).astype(np.int32))
    cv2.fillConvexPoly(mask, hull, cv2.GC_PR_FGD)
    cv2.polylines(mask, [hull], True, cv2.GC_PR_BGD, max(1, int(0.35 * length)))
    sure = max(2, int(0.5 * FINGER_WIDTH * length))
    for a, b in BONES:
        draw_line(mask, inside[a], inside[b], cv2.GC_FGD, sure)
    draw_line(mask, inside[0], reach[-1] - low, cv2.GC_PR_FGD, int(0.7 * length))
    draw_line(mask, inside[0], reach[-1] - low, cv2.GC_FGD, sure)
    cv2.fillPoly(mask, [np.round(inside[[0, 5, 9, 13, 17]]).astype(np.int32)], cv2.GC_FGD)
    cv2.setRNGSeed(0)
    empty = np.zeros((1, 65))
    cv2.grabCut(part, mask, None, empty, empty.copy(), 4, cv2.GC_INIT_WITH_MASK)
    skin = ((mask == cv2.GC_FGD) | (mask == cv2.GC_PR_FGD)).astype(np.uint8)
    _, parts = cv2.connectedComponents(skin)
    x, y = np.round(inside[list(PALM)].mean(axis=0)).astype(int)
    alpha = (parts == parts[y, x]).astype(np.float32) * skin
    return Sprite(part, cv2.GaussianBlur(alpha, (0, 0), 1.0), inside)


def film_sprites(path: Path, detector: HandDetector, every: int = 1) -> Iterator[Sprite]:
    """Yield the surest hand of every ``every``-th frame of a film.

    Raises
    ------
    IgripError
        If the film cannot be read.
    """
    film = cv2.VideoCapture(str(path))
    number = 0
    while True:
        good, picture = film.read()
        if not good:
            break
        colour = cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)
        height, width = colour.shape[:2]
        camera = Intrinsics(width, height, width, width, 0.5 * width, 0.5 * height)
        hands = detector.detect(RgbdFrame(number / 30.0, colour, None, camera))
        if hands and number % every == 0:
            yield cut_out(colour, hands[0].landmarks)
        number += 1
    film.release()
    if number == 0:
        raise IgripError(f"{path}: no film that can be read")
