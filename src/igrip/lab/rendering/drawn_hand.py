"""A drawn hand that can be put into frames, for cameras that are rendered.

Hand detectors are trained on photographs. A drawn hand needs none, and is detected as often as a
real one cut out of a film (docs/hands.md).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.rgbd import Array, RgbdFrame

PALM = (0, 5, 17)  # wrist, roots of the index and the little finger
PALM_LENGTH = 0.09  # m from the wrist to the knuckles of an adult's hand; guess
RELIEF = 0.012  # m by which the middle of a hand is nearer than its outline; guess
BONES = (
    (0, 1), (1, 2), (2, 3), (3, 4), (5, 6), (6, 7), (7, 8), (9, 10), (10, 11), (11, 12),
    (13, 14), (14, 15), (15, 16), (17, 18), (18, 19), (19, 20),
)  # fmt: skip
FOREARM = 3.0  # length of the arm, in distances of the palm's centre from the wrist
FINGER_WIDTH = 0.2  # in lengths of the palm
SKIN = np.array([225.0, 172.0, 145.0])
# landmarks of a spread right hand seen from its palm, wrist below; in lengths of the palm
OPEN_HAND = np.array([
    [0.0, 0.0], [0.32, -0.12], [0.55, -0.38], [0.72, -0.6], [0.88, -0.8],
    [0.3, -0.95], [0.38, -1.38], [0.42, -1.66], [0.45, -1.9],
    [0.06, -1.0], [0.08, -1.48], [0.09, -1.8], [0.1, -2.06],
    [-0.15, -0.95], [-0.2, -1.38], [-0.23, -1.68], [-0.25, -1.92],
    [-0.34, -0.83], [-0.46, -1.13], [-0.54, -1.34], [-0.6, -1.53],
])  # fmt: skip


class Sprite(NamedTuple):
    """A hand without a background."""

    colour: NDArray[np.uint8]  # (h, w, 3), RGB
    alpha: NDArray[np.float32]  # (h, w): 1 on the hand, 0 beside it
    landmarks: Array  # (21, 2), in MediaPipe's order [pixels of the sprite]

    @property
    def palm(self) -> Array:
        """The palm's centre, (2,) [pixels]."""
        centre: Array = self.landmarks[list(PALM)].mean(axis=0)
        return centre

    @property
    def palm_length(self) -> float:
        """The palm's length, wrist to knuckles or across [pixels]."""
        wrist, index, little = self.landmarks[list(PALM)]
        along = np.linalg.norm(0.5 * (index + little) - wrist)
        return float(max(along, np.linalg.norm(index - little)))


def draw_hand(landmarks: Array | None = None, length: float = 120.0, seed: int = 0) -> Sprite:
    """Draw a hand: a palm, fingers and an arm, rounded by their shading.

    ``landmarks`` (21, 2) are in lengths of the palm, by default a spread right hand seen from its
    palm; ``length`` is that of the palm [pixels]; ``seed`` that of the grain of its skin.
    """
    import cv2

    points = length * (OPEN_HAND if landmarks is None else np.asarray(landmarks, dtype=np.float64))
    arm = points[0] - points[list(PALM)].mean(axis=0)
    end = points[0] + FOREARM * arm
    low = np.vstack([points, end]).min(axis=0) - 0.5 * length
    points, end = points - low, end - low
    width, height = np.ceil(np.vstack([points, end]).max(axis=0) + 0.5 * length).astype(int)
    thick = FINGER_WIDTH * length
    relief = np.zeros((height, width), np.float32)  # of the skin, towards the viewer [pixels]
    palm: Any = np.zeros((height, width), np.uint8)
    outline = points[[0, 1, 2, 5, 9, 13, 17]]
    cv2.fillPoly(palm, [np.round(outline).astype(np.int32)], 1)
    draw_line(palm, points[0], end, 1, int(0.55 * length))
    for a, b in ((0, 1), (1, 2), (2, 5), (5, 9), (9, 13), (13, 17), (17, 0)):
        draw_line(palm, points[a], points[b], 1, int(1.2 * thick))
    parts = [palm]
    for a, b in BONES[1:]:
        finger = np.zeros((height, width), np.uint8)
        tip = b in (4, 8, 12, 16, 20)
        draw_line(finger, points[a], points[b], 1, int(thick * (0.85 if tip else 1.0)))
        parts.append(finger)
    for part in parts:  # a body's height over its outline is that of a half ellipse
        away = cv2.distanceTransform(part, cv2.DIST_L2, 5)
        radius = min(float(away.max()), 0.9 * thick)
        rounded = np.sqrt(np.maximum(1.0 - (1.0 - np.minimum(away / radius, 1.0)) ** 2, 0.0))
        relief = np.maximum(relief, radius * rounded)
    alpha = (relief > 0.0).astype(np.float32)
    relief = cv2.GaussianBlur(relief, (0, 0), 0.03 * length)
    light = 0.62 + 0.38 * _shading(relief)
    rng = np.random.default_rng(seed)
    grain: Any = cv2.GaussianBlur(rng.normal(0.0, 1.0, (height, width)), (0, 0), 1.5)
    broad: Any = cv2.GaussianBlur(rng.normal(0.0, 1.0, (height, width)), (0, 0), 0.15 * length)
    tone = 1.0 + 0.02 * grain / grain.std() + 0.05 * broad / broad.std()
    colour = SKIN * (light * tone)[..., None]
    colour[..., 1:] *= (1.0 - 0.06 * np.clip(broad / broad.std(), -2, 2))[..., None]
    return Sprite(
        np.clip(colour, 0, 255).astype(np.uint8), cv2.GaussianBlur(alpha, (0, 0), 1.0), points
    )


def _shading(relief: NDArray[np.float32]) -> Array:
    """Return how bright a matt surface of some height is, lit from above on the left, 0 to 1."""
    down, right = np.gradient(relief.astype(np.float64))
    light = np.array([-0.35, -0.45, 0.82])
    normal = np.stack([-right, -down, np.ones_like(down)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    bright: Array = np.clip(normal @ light, 0.0, 1.0)
    return bright


def draw_line(mask: NDArray[np.uint8], start: Array, end: Array, value: int, width: int) -> None:
    """Draw a line of some width into a mask, from and to (2,) pixels."""
    import cv2

    a, b = (tuple(round(float(x)) for x in point) for point in (start, end))
    cv2.line(mask, a, b, value, max(1, width))


def paste_hand(
    frame: RgbdFrame, sprite: Sprite, pixel: tuple[float, float], depth: float, turn: float = 0.0,
    light: float = 1.0,
) -> tuple[RgbdFrame, Array]:  # fmt: skip
    """Put a hand into a frame, as large as it looks at that depth, behind what is nearer.

    Parameters
    ----------
    frame, sprite
        Both left as they are.
    pixel : 2 floats
        Where its palm centre (mean of landmarks 0, 5, 17) goes.
    depth : float
        Of the palm's skin there [m].
    turn, light : float
        By which it is turned in the picture [rad], and how many times as bright as it was.

    Returns
    -------
    frame, landmarks : RgbdFrame, (21, 2)
        With the hand in colour and, where there is depth, in depth; and the hand's pixels.
    """
    import cv2

    scale = frame.intrinsics.fx * PALM_LENGTH / depth / sprite.palm_length
    c, s = scale * np.cos(turn), scale * np.sin(turn)
    linear = np.array([[c, -s], [s, c]])
    matrix = np.column_stack([linear, np.array(pixel) - linear @ sprite.palm])
    size = (frame.colour.shape[1], frame.colour.shape[0])
    smaller = scale < 1.0  # else fine grain would alias
    soft = cv2.GaussianBlur(sprite.colour, (0, 0), 0.4 / scale) if smaller else sprite.colour
    colour: Any = cv2.warpAffine(soft, matrix, size, borderMode=cv2.BORDER_REPLICATE)
    alpha: Any = cv2.warpAffine(sprite.alpha, matrix, size)
    measured = None
    if frame.depth is not None:
        body = (alpha > 0.5).astype(np.uint8)
        away = cv2.distanceTransform(body, cv2.DIST_L2, 5)
        at = np.clip(np.round(pixel).astype(int), 0, np.array(size) - 1)
        per_metre = frame.intrinsics.fx / depth
        relief = np.minimum(away / per_metre, RELIEF)
        skin = depth + relief[at[1], at[0]] - relief
        hidden = (frame.depth > 0.0) & (frame.depth < skin)
        alpha = np.where(hidden, 0.0, alpha)
        measured = np.where(alpha > 0.5, skin, frame.depth).astype(np.float32)
    mixed = frame.colour + alpha[..., None] * (light * colour.astype(np.float64) - frame.colour)
    picture = np.clip(np.round(mixed), 0, 255).astype(np.uint8)
    landmarks = sprite.landmarks @ linear.T + matrix[:, 2]
    return replace(frame, colour=picture, depth=measured), landmarks
