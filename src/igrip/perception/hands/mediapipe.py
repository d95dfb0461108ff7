"""Hands by MediaPipe: the whole picture first, and square tiles of it for hands that are missed.

The whole picture goes through MediaPipe's video mode, which follows a known hand at a third of the
cost of detecting it and holds on to hands that the palm network does not detect anew. Only where
fewer hands are detected than were known a moment ago, and now and then in any case, one square tile
of the picture, with the known hands painted over, is searched besides; a hand that is detected in
one is followed there by a second landmarker in video mode.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.errors import requires_extra
from igrip.perception.hands import HANDS, HandDetection
from igrip.perception.hands._image_tiles import Tile, distinct, is_stump, search_tiles, tile_around
from igrip.perception.hands._mediapipe_model import hand_model
from igrip.perception.opencv import load_opencv
from igrip.perception.options import validated
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings, quantity

MAX_MISSES = 3  # frames without the hand until a tile is given up; guess


class MediaPipeConfig(Settings):
    """How many hands, how surely, and how hard to look for those that are missed."""

    max_hands: int = quantity(
        2, "1", "hands that are reported", "two hands of one person", ge=1, le=4
    )
    min_detection: float = quantity(
        0.5, "1", "score from which on a palm is detected", "MediaPipe", gt=0, lt=1
    )
    min_presence: float = quantity(
        0.5, "1", "score from which on it is a hand", "MediaPipe", gt=0, lt=1
    )
    memory: float = quantity(1.0, "s", "for which a hand is expected to be back", "guess", ge=0)
    tiles: int = quantity(
        1, "1", "tiles searched in a frame with fewer hands than expected", "docs/hands.md", ge=0
    )
    search_every: int = quantity(
        5, "1", "frames between tiles searched for hands that are not expected", "docs/hands.md",
        ge=1,
    )  # fmt: skip


@dataclass
class _CameraState:
    """What is kept of one camera."""

    landmarker: Any
    stamp: int = -1  # of the newest frame [ms]
    times: list[float] = field(default_factory=list)  # when the k-th hand was last detected
    tile_landmarker: Any = None
    tile_stamp: int = 0
    followed: Tile | None = None  # where the second landmarker detected a hand
    misses: int = 0  # frames since
    incomplete: int = 0  # frames with fewer hands than there may be
    searched: int = 0  # and how many of them were searched


@HANDS.register("mediapipe")
class MediaPipeHands:
    """MediaPipe's hand landmarks, without any network look-up.

    ``options`` are the fields of :class:`MediaPipeConfig`.

    Raises
    ------
    MissingExtraError
        If MediaPipe or OpenCV is not installed.
    IgripError
        If the model is neither in the cache nor to be had (``hands/_mediapipe_model.py``).
    """

    def __init__(self, options: Mapping[str, Any] | MediaPipeConfig | None = None) -> None:
        load_opencv("detecting hands")
        with requires_extra("mediapipe", "hands", "detecting hands"):
            import mediapipe
            from mediapipe.tasks.python import BaseOptions, vision
        self._config = validated(MediaPipeConfig, "hands mediapipe", options)
        self._mediapipe, self._vision = mediapipe, vision
        self._base = BaseOptions(model_asset_path=str(hand_model()))
        self._cameras: dict[str, _CameraState] = {}

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first. Reads the colour picture alone."""
        config = self._config
        camera = self._cameras.get(frame.camera)
        if camera is None or round(1e3 * frame.t) < camera.stamp:  # another run: nothing is known
            self._forget(frame.camera)
            camera = _CameraState(self._landmarker(config.max_hands))
            self._cameras[frame.camera] = camera
        camera.stamp = max(round(1e3 * frame.t), camera.stamp + 1)
        picture = np.ascontiguousarray(frame.colour)
        answer = camera.landmarker.detect_for_video(self._image(picture), camera.stamp)
        hands = distinct(_detections(answer, picture, np.eye(2, 3)))
        if len(hands) < config.max_hands:
            hands = self._search(camera, frame, picture, hands)
        camera.times = [
            frame.t if k < len(hands) else camera.times[k]
            for k in range(max(len(hands), len(camera.times)))
        ]
        return sorted(hands, key=lambda hand: -hand.score)

    def close(self) -> None:
        """Release the networks."""
        for camera in list(self._cameras):
            self._forget(camera)

    def _forget(self, camera: str) -> None:
        known = self._cameras.pop(camera, None)
        for landmarker in (known.landmarker, known.tile_landmarker) if known else ():
            if landmarker is not None:
                landmarker.close()

    def _search(
        self, camera: _CameraState, frame: RgbdFrame, picture: NDArray[np.uint8],
        hands: list[HandDetection],
    ) -> list[HandDetection]:  # fmt: skip
        """Return the hands and those that were missed, as far as tiles show them."""
        config = self._config
        expected = sum(frame.t - t <= config.memory for t in camera.times)
        tiles = [] if camera.followed is None else [camera.followed]
        camera.incomplete += 1
        due = len(hands) < expected or camera.incomplete % config.search_every == 0
        if config.tiles and due:
            more = search_tiles(frame.intrinsics, hands)
            first = camera.searched * config.tiles
            tiles += [more[(first + k) % len(more)] for k in range(config.tiles)]
            camera.searched += 1
        for tile in tiles:
            if len(hands) >= config.max_hands:
                break
            together = self._search_tile(camera, tile, picture, hands)
            if len(together) > len(hands):
                hands, camera.followed, camera.misses = together, tile, 0
                if not tile.holds(together[-1].landmarks):
                    camera.followed = tile_around(together[-1].landmarks, tile.turn)
            elif tile is camera.followed:
                camera.misses += 1
                if camera.misses > MAX_MISSES:
                    camera.followed = None
        return hands

    def _search_tile(
        self, camera: _CameraState, tile: Tile, picture: NDArray[np.uint8],
        hands: list[HandDetection],
    ) -> list[HandDetection]:  # fmt: skip
        """Return the hands, and after them that which a tile shows besides."""
        pixels, back = tile.render(picture, hands)
        if camera.tile_landmarker is None:
            camera.tile_landmarker = self._landmarker(1)
        camera.tile_stamp += 1
        answer = camera.tile_landmarker.detect_for_video(self._image(pixels), camera.tile_stamp)
        new = [
            hand
            for hand in _detections(answer, pixels, back)
            if not any(is_stump(hand.landmarks, known.landmarks) for known in hands)
        ]
        return distinct([*hands, *new])

    def _landmarker(self, hands: int) -> Any:
        options = self._vision.HandLandmarkerOptions(
            base_options=self._base,
            running_mode=self._vision.RunningMode.VIDEO,
            num_hands=hands,
            min_hand_detection_confidence=self._config.min_detection,
            min_hand_presence_confidence=self._config.min_presence,
            min_tracking_confidence=self._config.min_presence,
        )
        return self._vision.HandLandmarker.create_from_options(options)

    def _image(self, picture: NDArray[np.uint8]) -> Any:
        srgb = self._mediapipe.ImageFormat.SRGB
        return self._mediapipe.Image(image_format=srgb, data=picture)


def _detections(
    answer: Any, picture: NDArray[np.uint8], back: NDArray[np.float64]
) -> list[HandDetection]:
    """Return the hands of MediaPipe's result; ``back`` (2, 3) maps pixels to the whole picture."""
    hands = []
    size = np.array(picture.shape[1::-1], dtype=np.float64)
    for landmarks, (label, *_) in zip(answer.hand_landmarks, answer.handedness, strict=True):
        # MediaPipe counts from the outer edge of the first pixel; centres are whole here
        pixels = np.array([[point.x, point.y] for point in landmarks]) * size - 0.5
        name = label.category_name.lower()
        side = name if name in ("left", "right") else None
        score = float(np.clip(label.score, 0.0, 1.0))
        hands.append(HandDetection(pixels @ back[:, :2].T + back[:, 2], score, side))
    return sorted(hands, key=lambda hand: -hand.score)
