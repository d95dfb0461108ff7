"""The lens of a camera, from a board that is moved about before it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from igrip.errors import CameraError
from igrip.perception.calibration.board import Board, BoardDetector
from igrip.perception.lens import LensModel
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Array, Intrinsics, RgbdFrame

VIEWS = 15  # of the board, each from elsewhere; OpenCV's manual asks for at least 10
MIN_VIEWS = 8
MIN_TAGS = 4  # in a picture
MIN_MOTION = 0.04  # of the picture's width, which corners must have moved by on average; guess
MAX_ERROR = 1.0  # pixels, root mean square; guess


class LensCalibration(NamedTuple):
    """A lens that was calibrated."""

    lens: LensModel
    error: float  # root mean square of the distances of corners from where they should be [pixels]
    views: int  # pictures that were used


def calibrate_lens(
    frames: Iterable[RgbdFrame], board: Board, seconds: float = 60.0, views: int = VIEWS
) -> LensCalibration:
    """Calibrate a lens while the board is held before it here and there, near and tilted.

    Zhang's method (2000, IEEE PAMI 22:1330-1334) by OpenCV, on pictures that differ enough, of one
    camera that is not rectified yet. It ends after ``seconds`` of the frames' own time, or once it
    has so many views.

    Raises
    ------
    CameraError
        If too few pictures differ enough, or the fit is poor.
    """
    detector, kept = BoardDetector(board), list[Mapping[int, Array]]()
    first: float | None = None
    size = (0, 0)
    for frame in frames:
        first = frame.t if first is None else first
        size = frame.intrinsics.width, frame.intrinsics.height
        corners = detector.detect(frame)
        if len(corners) >= MIN_TAGS and all(_differs(corners, other, size[0]) for other in kept):
            kept.append(corners)
        if len(kept) >= views or frame.t - first >= seconds:
            break
    if len(kept) < min(views, MIN_VIEWS):
        raise CameraError(
            f"the board was seen in {len(kept)} places, {MIN_VIEWS} are needed: move it about the "
            "whole picture, near and far, tilted to all sides"
        )
    cv2 = load_opencv("calibration")
    points = [
        np.concatenate([board.corners(id) for id in corners]).astype(np.float32) for corners in kept
    ]
    pixels = [np.concatenate(list(corners.values())).astype(np.float32) for corners in kept]
    error, matrix, distortion, _, _ = cv2.calibrateCamera(points, pixels, size, None, None)
    if not error <= MAX_ERROR:
        raise CameraError(
            f"corners lie {error:.2f} pixels from where they should (at most {MAX_ERROR:g}): is "
            "the board flat, and was it held still enough not to blur?"
        )
    pinhole = Intrinsics(*size, *(float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))))
    lens = LensModel(pinhole, tuple(float(value) for value in distortion.ravel()))
    return LensCalibration(lens, float(error), len(kept))


def _differs(corners: Mapping[int, Array], other: Mapping[int, Array], width: int) -> bool:
    """Whether the corners that two pictures share lie elsewhere."""
    both = corners.keys() & other.keys()
    if not both:
        return True
    moved = np.mean([np.linalg.norm(corners[id] - other[id], axis=1).mean() for id in both])
    return bool(moved > MIN_MOTION * width)
