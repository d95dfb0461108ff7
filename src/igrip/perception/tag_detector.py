"""AprilTags in pictures: the one place that knows the library, for objects and for the board."""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np

from igrip.errors import UnknownNameError, requires_extra
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Array, RgbdFrame

FAMILIES = ("tag16h5", "tag25h9", "tag36h11", "tagStandard41h12", "tagStandard52h13")
MIN_MARGIN = 20.0  # how surely the bits of a tag are read, 0 to about 150; guess


class TagDetection(NamedTuple):
    """One tag in a picture.

    Attributes
    ----------
    id : int
        Its number in the family.
    corners : (4, 2)
        Lower left, lower right, upper right, upper left of its black square, as the AprilTag
        project prints it [pixels]. OpenCV draws tags of the same family upside down: of such a
        print the order is upper right, upper left, lower left, lower right.
    """

    id: int
    corners: Array


class TagDetector:
    """Detects the tags of one family.

    Parameters
    ----------
    family : str
        ``tag36h11`` or another of AprilTag 3 (Krogius, Haggenmiller & Olson 2019).
    decimate : float
        Quads are looked for in a picture so many times smaller; corners are refined in full.

    Raises
    ------
    MissingExtraError
        If pupil-apriltags or OpenCV is not installed.
    UnknownNameError
        If there is no such family.
    """

    def __init__(self, family: str = "tag36h11", decimate: float = 2.0) -> None:
        if family not in FAMILIES:
            raise UnknownNameError("tag family", family, FAMILIES)
        self._cv2 = load_opencv("detecting tags")
        with requires_extra("pupil-apriltags", "poses", "detecting tags"):
            import pupil_apriltags

        class Detector(pupil_apriltags.Detector):  # type: ignore[misc]
            """Freed in the right order: pupil-apriltags frees what its detector still uses."""

            def __del__(self) -> None:
                pointer: Any = getattr(self, "tag_detector_ptr", None)
                self.tag_detector_ptr = None
                if pointer is not None:
                    self.libc.apriltag_detector_destroy.restype = None
                    self.libc.apriltag_detector_destroy(pointer)

        self._detector: Any = Detector(families=family, nthreads=1, quad_decimate=decimate)

    def detect(self, frame: RgbdFrame) -> list[TagDetection]:
        """Return the tags in the colour picture, without numbers that are there twice."""
        grey = self._cv2.cvtColor(frame.colour, self._cv2.COLOR_RGB2GRAY)
        tags = [
            tag
            for tag in self._detector.detect(np.ascontiguousarray(grey))
            if tag.hamming == 0 and tag.decision_margin >= MIN_MARGIN
        ]
        count = Counter(tag.tag_id for tag in tags)
        # the library counts from the outer edge of the first pixel; centres are whole here
        return [
            TagDetection(int(tag.tag_id), np.asarray(tag.corners, dtype=np.float64) - 0.5)
            for tag in tags
            if count[tag.tag_id] == 1
        ]
