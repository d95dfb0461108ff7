"""The lens of a colour camera: from a file, from its field of view, or found with a board."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.perception.calibration.board import Board, CornerFinder
from igrip.perception.cameras import CameraError
from igrip.rgbd import Array, Intrinsics, RgbdFrame

USUAL_FOV = 65.0  # degrees across; webcams have 55 to 80; guess
VIEWS = 15  # of the board, each from elsewhere; OpenCV's manual asks for at least 10
ELSEWHERE = 0.04  # of the picture's width, which corners must have moved by on average; guess
WORST = 1.0  # pixels, root mean square; guess


def load_cv2() -> Any:
    """Return the module.

    Raises
    ------
    CameraError
        If it is not installed.
    """
    try:
        import cv2
    except ImportError:
        raise CameraError("this needs OpenCV: pip install opencv-python-headless") from None
    return cv2


class Lens:
    """The intrinsics of a colour camera, and its rectification.

    Parameters
    ----------
    path : str
        A JSON file with ``width``, ``height``, ``fx``, ``fy``, ``cx``, ``cy`` [pixels] and perhaps
        ``distortion``, OpenCV's ``k1, k2, p1, p2, k3``; empty: the field of view decides.
    fov : float
        Across the picture [degrees]; 0: not known.

    Attributes
    ----------
    note : str or None
        What is not known and was assumed.

    Raises
    ------
    CameraError
        If the file cannot be read.
    """

    def __init__(self, path: str = "", fov: float = 0.0) -> None:
        self.note: str | None = None
        self._told: Intrinsics | None = None
        self._distortion: list[float] = []
        self._maps: tuple[Any, Any] | None = None
        if path:
            self._told, self._distortion = _read_lens(Path(path))
        elif fov:
            if not 1.0 <= fov <= 170.0:
                raise CameraError(f"fov: must be 1 to 170 degrees, not {fov:g}")
        else:
            fov = USUAL_FOV
            self.note = (
                f"its field of view is assumed to be {fov:g}° across, so distances may be wrong by "
                "a quarter; say ?fov= or ?intrinsics="
            )
        self._fov = fov

    def see(self, colour: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], Intrinsics]:
        """Return the rectified picture and its intrinsics."""
        height, width = colour.shape[:2]
        if self._told is None:
            f = width / 2 / math.tan(math.radians(self._fov) / 2)
            return colour, Intrinsics(width, height, f, f, (width - 1) / 2, (height - 1) / 2)
        if width * self._told.height != height * self._told.width:
            raise CameraError(
                f"the picture is {width} × {height}, but its intrinsics are of "
                f"{self._told.width} × {self._told.height}"
            )
        own = self._told.scaled(width, height)
        if not any(self._distortion):
            return colour, own
        cv2 = load_cv2()
        if self._maps is None or self._maps[0].shape[:2] != (height, width):
            self._maps = cv2.initUndistortRectifyMap(
                own.matrix, np.array(self._distortion), None, own.matrix, (width, height),
                cv2.CV_16SC2,
            )  # fmt: skip
        assert self._maps is not None
        return np.asarray(cv2.remap(colour, *self._maps, cv2.INTER_LINEAR)), own


def _read_lens(path: Path) -> tuple[Intrinsics, list[float]]:
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        own = Intrinsics(int(told["width"]), int(told["height"]),
                         *(float(told[key]) for key in ("fx", "fy", "cx", "cy")))  # fmt: skip
        distortion = [float(value) for value in told.get("distortion", [])]
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no file of intrinsics: {error!r}") from None
    if not np.isfinite([*own, *distortion]).all() or min(own[:4]) <= 0:
        raise CameraError(f"{path}: sizes and focal lengths must be positive numbers")
    return own, distortion


class FoundLens(NamedTuple):
    """A lens that was found.

    Attributes
    ----------
    intrinsics : Intrinsics
        The pinhole.
    distortion : tuple of float
        OpenCV's ``k1, k2, p1, p2, k3``.
    error : float
        Root mean square of the distances of corners from where they should be [pixels].
    views : int
        How many pictures were used.
    """

    intrinsics: Intrinsics
    distortion: tuple[float, ...]
    error: float
    views: int

    def write(self, path: str | Path) -> None:
        """Write the file that :class:`Lens` reads.

        Raises
        ------
        CameraError
            If it cannot be written.
        """
        told = {**self.intrinsics._asdict(), "distortion": self.distortion,
                "reprojection_px": round(self.error, 4)}  # fmt: skip
        try:
            Path(path).write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            raise CameraError(f"{path}: {error.strerror or error}") from error


def find_lens(
    frames: Iterable[RgbdFrame], board: Board, seconds: float = 60.0, views: int = VIEWS
) -> FoundLens:
    """Find a lens while the board is held before it here and there, near and tilted.

    Zhang's method (2000, IEEE PAMI 22:1330-1334) by OpenCV, on pictures that differ enough.

    Parameters
    ----------
    frames : iterable of RgbdFrame
        Of one camera that is not rectified yet.
    board : Board
        What is held before it.
    seconds : float
        At most so long, by the frames' own time.
    views : int
        Pictures that are enough.

    Raises
    ------
    CameraError
        If too few pictures differ enough, or the fit is poor.
    """
    finder, kept = CornerFinder(board), list[Mapping[int, Array]]()
    first: float | None = None
    size = (0, 0)
    for frame in frames:
        first = frame.t if first is None else first
        size = frame.intrinsics.width, frame.intrinsics.height
        found = finder.find(frame)
        if len(found) >= 4 and all(_differs(found, other, size[0]) for other in kept):
            kept.append(found)
        if len(kept) >= views or frame.t - first >= seconds:
            break
    if len(kept) < min(views, 8):
        raise CameraError(
            f"the board was seen in {len(kept)} places, 8 are needed: move it about the whole "
            "picture, near and far, tilted to all sides"
        )
    cv2 = load_cv2()
    points = [np.concatenate([board.corners(id) for id in seen]).astype(np.float32)
              for seen in kept]  # fmt: skip
    pixels = [np.concatenate(list(seen.values())).astype(np.float32) for seen in kept]
    error, k, bent, _, _ = cv2.calibrateCamera(points, pixels, size, None, None)
    if not error <= WORST:
        raise CameraError(
            f"corners lie {error:.2f} pixels from where they should (at most {WORST:g}): is the "
            "board flat, and was it held still enough not to blur?"
        )
    own = Intrinsics(*size, *(float(k[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))))
    return FoundLens(own, tuple(float(value) for value in bent.ravel()), float(error), len(kept))


def _differs(found: Mapping[int, Array], other: Mapping[int, Array], width: int) -> bool:
    """Whether the corners that two pictures share lie elsewhere."""
    both = found.keys() & other.keys()
    if not both:
        return True
    moved = np.mean([np.linalg.norm(found[id] - other[id], axis=1).mean() for id in both])
    return bool(moved > ELSEWHERE * width)
