"""The lens of a colour camera: its file, its field of view, and the rectification of pictures."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import CameraError
from igrip.perception.json_files import read_json, write_json
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Intrinsics

USUAL_FOV = 65.0  # degrees across; webcams have 55 to 80; guess


class LensModel(NamedTuple):
    """A pinhole, and the distortion that is taken out before it holds."""

    intrinsics: Intrinsics
    distortion: tuple[float, ...] = ()  # OpenCV's k1, k2, p1, p2, k3


def read_lens(path: str | Path) -> LensModel:
    """Read a JSON file with ``width``, ``height``, ``fx``, ``fy``, ``cx``, ``cy`` [pixels].

    It may also hold ``distortion``, as in :class:`LensModel`. What makes no sense is a CameraError.
    """
    return read_json(path, "file of intrinsics", _lens)


def _lens(content: Any) -> LensModel:
    pinhole = (float(content[key]) for key in ("fx", "fy", "cx", "cy"))
    intrinsics = Intrinsics(int(content["width"]), int(content["height"]), *pinhole)
    distortion = tuple(float(value) for value in content.get("distortion", []))
    if not np.isfinite([*intrinsics, *distortion]).all() or min(intrinsics[:4]) <= 0:
        raise ValueError("sizes and focal lengths must be positive numbers")
    return LensModel(intrinsics, distortion)


def write_lens(path: str | Path, lens: LensModel, error: float) -> None:
    """Write the file that :func:`read_lens` reads, with the reprojection error [pixels]."""
    content = {**lens.intrinsics._asdict(), "distortion": lens.distortion}
    write_json(path, {**content, "reprojection_px": round(error, 4)})


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
        """Return the rectified picture and its intrinsics."""
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
