"""The lens of a colour camera: its file, its field of view, and the rectification of pictures."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import CameraError
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Intrinsics

USUAL_FOV = 65.0  # degrees across; webcams have 55 to 80; guess


class LensModel(NamedTuple):
    """A pinhole and the distortion that is taken out before it holds.

    Attributes
    ----------
    intrinsics : Intrinsics
        The pinhole.
    distortion : tuple of float
        OpenCV's ``k1, k2, p1, p2, k3``; empty: none.
    """

    intrinsics: Intrinsics
    distortion: tuple[float, ...] = ()


def read_lens(path: str | Path) -> LensModel:
    """Read a JSON file with ``width``, ``height``, ``fx``, ``fy``, ``cx``, ``cy`` [pixels].

    It may also hold ``distortion``, as in :class:`LensModel`.

    Raises
    ------
    CameraError
        If the file cannot be read, or its numbers make no sense.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        intrinsics = Intrinsics(
            int(content["width"]), int(content["height"]),
            *(float(content[key]) for key in ("fx", "fy", "cx", "cy")),
        )  # fmt: skip
        distortion = tuple(float(value) for value in content.get("distortion", []))
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no file of intrinsics: {error!r}") from None
    if not np.isfinite([*intrinsics, *distortion]).all() or min(intrinsics[:4]) <= 0:
        raise CameraError(f"{path}: sizes and focal lengths must be positive numbers")
    return LensModel(intrinsics, distortion)


def write_lens(path: str | Path, lens: LensModel, error: float) -> None:
    """Write the file that :func:`read_lens` reads, with the reprojection error [pixels].

    Raises
    ------
    CameraError
        If it cannot be written.
    """
    content = {
        **lens.intrinsics._asdict(),
        "distortion": lens.distortion,
        "reprojection_px": round(error, 4),
    }
    try:
        Path(path).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    except OSError as problem:
        raise CameraError(f"{path}: {problem.strerror or problem}") from problem


class Rectifier:
    """Rectifies the pictures of a camera whose lens or field of view is given.

    Parameters
    ----------
    path : str
        A file as of :func:`read_lens`; empty: the field of view decides.
    fov : float
        Across the picture [degrees]; 0: not known.

    Attributes
    ----------
    note : str or None
        What is not known and was assumed.

    Raises
    ------
    CameraError
        If the file cannot be read, or the field of view makes no sense.
    """

    def __init__(self, path: str = "", fov: float = 0.0) -> None:
        self.note: str | None = None
        self._lens = read_lens(path) if path else None
        self._maps: tuple[Any, Any] | None = None
        if fov and not 1.0 <= fov <= 170.0:
            raise CameraError(f"fov: must be 1 to 170 degrees, not {fov:g}")
        if not path and not fov:
            self.note = (
                f"its field of view is assumed to be {USUAL_FOV:g}° across, so distances may be "
                "wrong by a quarter; give ?fov= or ?intrinsics="
            )
        self._fov = fov or USUAL_FOV

    def rectify(self, colour: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], Intrinsics]:
        """Return the rectified picture and its intrinsics.

        Raises
        ------
        CameraError
            If the picture does not have the proportions of the lens file.
        """
        height, width = colour.shape[:2]
        if self._lens is None:
            f = width / 2 / math.tan(math.radians(self._fov) / 2)
            return colour, Intrinsics(width, height, f, f, (width - 1) / 2, (height - 1) / 2)
        calibrated = self._lens.intrinsics
        if width * calibrated.height != height * calibrated.width:
            raise CameraError(
                f"the picture is {width} × {height}, but its intrinsics are of "
                f"{calibrated.width} × {calibrated.height}"
            )
        intrinsics = calibrated.scaled(width, height)
        if not any(self._lens.distortion):
            return colour, intrinsics
        cv2 = load_opencv("taking distortion out")
        if self._maps is None or self._maps[0].shape[:2] != (height, width):
            self._maps = cv2.initUndistortRectifyMap(
                intrinsics.matrix, np.array(self._lens.distortion), None, intrinsics.matrix,
                (width, height), cv2.CV_16SC2,
            )  # fmt: skip
        assert self._maps is not None
        return np.asarray(cv2.remap(colour, *self._maps, cv2.INTER_LINEAR)), intrinsics
