"""Hands by MediaPipe: the whole picture first, and square views of it for hands that are missed.

The whole picture goes through MediaPipe's video mode, which follows a known hand at a third of the
cost of finding it and holds on to hands that the palm network does not find anew. Only where fewer
hands are found than were known a moment ago, and now and then in any case, one square view of the
picture, with the known hands covered up, is searched besides; a hand that is found in one is
followed there by a second landmarker in video mode.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import MissingExtraError
from igrip.perception.hand_detection.image_tiles import (
    View,
    around,
    distinct,
    is_stump,
    search_views,
)
from igrip.perception.hand_detection.mediapipe_model import hand_model
from igrip.perception.hands import HANDS, HandDetection
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings, quantity

PATIENCE = 3  # frames without the hand until a view of it is given up; guess


class MediaPipeConfig(Settings):
    """How many hands, how surely, and how hard to look for those that are missed."""

    hands: int = quantity(2, "1", "at most so many hands are reported", "DESIGN", ge=1, le=4)
    detection: float = quantity(0.5, "1", "a palm is found from here on", "MediaPipe", gt=0, lt=1)
    presence: float = quantity(0.5, "1", "and is a hand from here on", "MediaPipe", gt=0, lt=1)
    memory: float = quantity(1.0, "s", "a hand that was seen so lately is expected", "guess", ge=0)
    views: int = quantity(
        1, "1", "views searched in a frame with fewer hands than expected", "docs/hands.md", ge=0
    )
    every: int = quantity(
        5, "1", "frames between views searched for hands that nobody expects", "docs/hands.md",
        ge=1,
    )  # fmt: skip


@dataclass
class _Seen:
    """What is kept of one camera."""

    landmarker: Any
    stamp: int = -1  # of the newest frame [ms]
    times: list[float] = field(default_factory=list)  # when the k-th hand was last seen
    second: Any = None  # the landmarker of views
    looks: int = 0  # of the second
    followed: View | None = None  # where it found a hand
    misses: int = 0  # frames since
    turn: int = 0  # frames with fewer hands than there may be
    searched: int = 0  # and how many of them were searched


@HANDS.register("mediapipe")
class MediaPipeHands:
    """MediaPipe's hand landmarks, without any network look-up.

    Parameters
    ----------
    config : MediaPipeConfig, optional
        How many and how surely.

    Raises
    ------
    MissingExtraError
        If MediaPipe or OpenCV is not installed.
    IgripError
        If the model is neither in the cache nor to be had (see ``mediapipe_model``).
    """

    def __init__(self, config: MediaPipeConfig | None = None) -> None:
        try:
            import cv2  # noqa: F401
            import mediapipe
            from mediapipe.tasks.python import BaseOptions, vision
        except ImportError as error:
            missing = (error.name or "mediapipe").split(".")[0]
            package = "opencv-python-headless" if missing == "cv2" else "mediapipe"
            raise MissingExtraError(package, "hands", "finding hands") from None
        self._config = config or MediaPipeConfig()
        self._mediapipe, self._vision = mediapipe, vision
        self._base = BaseOptions(model_asset_path=str(hand_model()))
        self._cameras: dict[str, _Seen] = {}

    def find(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first. Reads the colour picture alone."""
        config = self._config
        camera = self._cameras.get(frame.camera)
        if camera is None or round(1e3 * frame.t) < camera.stamp:  # another run: nothing is known
            self._forget(frame.camera)
            camera = _Seen(self._landmarker("VIDEO", config.hands))
            self._cameras[frame.camera] = camera
        camera.stamp = max(round(1e3 * frame.t), camera.stamp + 1)
        picture = np.ascontiguousarray(frame.colour)
        found = camera.landmarker.detect_for_video(self._image(picture), camera.stamp)
        hands = distinct(_hands(found, picture, np.eye(2, 3)))
        if len(hands) < config.hands:
            hands = self._search(camera, frame, picture, hands)
        camera.times = [
            frame.t if k < len(hands) else camera.times[k]
            for k in range(max(len(hands), len(camera.times)))
        ]
        return sorted(hands, key=lambda hand: -hand.score)

    def close(self) -> None:
        """Let go of the networks."""
        for camera in list(self._cameras):
            self._forget(camera)

    def _forget(self, camera: str) -> None:
        known = self._cameras.pop(camera, None)
        for landmarker in (known.landmarker, known.second) if known else ():
            if landmarker is not None:
                landmarker.close()

    def _search(
        self,
        camera: _Seen,
        frame: RgbdFrame,
        picture: NDArray[np.uint8],
        hands: list[HandDetection],
    ) -> list[HandDetection]:
        """Return the hands and those that were missed, as far as views show them."""
        config = self._config
        expected = sum(frame.t - seen <= config.memory for seen in camera.times)
        views = [] if camera.followed is None else [camera.followed]
        camera.turn += 1
        if config.views and (len(hands) < expected or camera.turn % config.every == 0):
            more = search_views(frame.intrinsics, hands)
            first = camera.searched * config.views
            views += [more[(first + k) % len(more)] for k in range(config.views)]
            camera.searched += 1
        for view in views:
            if len(hands) >= config.hands:
                break
            found = self._look(camera, view, picture, hands)
            if len(found) > len(hands):
                hands, camera.followed, camera.misses = found, view, 0
                if not view.holds(found[-1].landmarks):
                    camera.followed = around(found[-1].landmarks, view.turn)
            elif view is camera.followed:
                camera.misses += 1
                if camera.misses > PATIENCE:
                    camera.followed = None
        return hands

    def _look(
        self, camera: _Seen, view: View, picture: NDArray[np.uint8], hands: list[HandDetection]
    ) -> list[HandDetection]:
        """Return the hands, and after them that which a view shows besides."""
        seen, back = view.render(picture, hands)
        if camera.second is None:
            camera.second = self._landmarker("VIDEO", 1)
        camera.looks += 1
        answer = camera.second.detect_for_video(self._image(seen), camera.looks)
        finds = [
            find
            for find in _hands(answer, seen, back)
            if not any(is_stump(find.landmarks, known.landmarks) for known in hands)
        ]
        return distinct([*hands, *finds])

    def _landmarker(self, mode: str, hands: int) -> Any:
        options = self._vision.HandLandmarkerOptions(
            base_options=self._base,
            running_mode=self._vision.RunningMode[mode],
            num_hands=hands,
            min_hand_detection_confidence=self._config.detection,
            min_hand_presence_confidence=self._config.presence,
            min_tracking_confidence=self._config.presence,
        )
        return self._vision.HandLandmarker.create_from_options(options)

    def _image(self, picture: NDArray[np.uint8]) -> Any:
        form = self._mediapipe.ImageFormat.SRGB
        return self._mediapipe.Image(image_format=form, data=picture)


def _hands(
    found: Any, picture: NDArray[np.uint8], back: NDArray[np.float64]
) -> list[HandDetection]:
    """Return the hands of MediaPipe's answer; ``back`` (2, 3) takes pixels to the whole picture."""
    hands = []
    size = np.array(picture.shape[1::-1], dtype=np.float64)
    for landmarks, (label, *_) in zip(found.hand_landmarks, found.handedness, strict=True):
        # MediaPipe counts from the outer edge of the first pixel; centres are whole here
        pixels = np.array([[point.x, point.y] for point in landmarks]) * size - 0.5
        name = label.category_name.lower()
        hands.append(
            HandDetection(
                pixels @ back[:, :2].T + back[:, 2],
                float(np.clip(label.score, 0.0, 1.0)),
                name if name in ("left", "right") else None,
            )
        )
    return sorted(hands, key=lambda hand: -hand.score)
