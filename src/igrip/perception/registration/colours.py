"""How similar an object's colours are to those of a reference picture, whatever the light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.perception.opencv import load_opencv
from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.view import DepthView

Palette = NDArray[np.float64]
"""Share of each of 10 x 10 bins of r/(r+g+b) and g/(r+g+b), shape (10, 10)."""

BINS = 10
MIN_BRIGHTNESS = 40  # sum of channels, of 765; darker pixels have no colour to speak of
SAME = 0.6  # from this Bhattacharyya coefficient on colours count as the same; guess
ON_SURFACE = 0.02  # of the depth where the object should be, a pixel is the object's [m]; guess
MIN_PIXELS = 10  # of an object


def read_picture(path: str | Path) -> NDArray[np.uint8]:
    """Return a picture, (h, w, 3) red, green, blue, or raise an IgripError."""
    cv2 = load_opencv("reading pictures")
    picture = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if picture is None:
        raise IgripError(f"{path}: cannot be read as a picture")
    return np.ascontiguousarray(picture[..., ::-1])


def palette_of(colours: NDArray[np.uint8]) -> Palette:
    """Return how often colours (…, 3) occur, smoothed over neighbouring bins."""
    flat = colours.reshape(-1, 3).astype(np.float64)
    total = flat.sum(axis=1)
    flat = flat[total > MIN_BRIGHTNESS] / total[total > MIN_BRIGHTNESS, None]
    bins = np.minimum((flat[:, :2] * BINS).astype(int), BINS - 1)
    counts = np.zeros((BINS + 2, BINS + 2))
    np.add.at(counts, (bins[:, 0] + 1, bins[:, 1] + 1), 1.0)
    smooth = counts.copy()
    for axis in range(2):
        smooth = 0.5 * smooth + 0.25 * (np.roll(smooth, 1, axis) + np.roll(smooth, -1, axis))
    palette: Palette = smooth[1:-1, 1:-1] / max(float(smooth[1:-1, 1:-1].sum()), 1e-9)
    return palette


def colour_similarity(
    fit: PoseFit, view: DepthView, colour: NDArray[np.uint8], palette: Palette
) -> float:
    """Return how similar to the palette the colours of an object in a picture are, 0 to 1."""
    pose = fit.pose.after(view.camera_from_table)
    points = pose.apply(fit.shape.surface.points)
    facing = -((fit.shape.surface.normals @ pose.rotation.T) * points).sum(axis=1) > 0.0
    points = points[facing & (points[:, 2] > 0.0)]
    pixels = np.round(view.intrinsics.pixels(points)).astype(int)
    height, width = view.depth.shape
    inside = ((pixels >= 0) & (pixels < (width, height))).all(axis=1)
    pixels, z = pixels[inside], points[inside, 2]
    measured = view.depth[pixels[:, 1], pixels[:, 0]]
    own = np.abs(measured - z) < ON_SURFACE
    if own.sum() < MIN_PIXELS:
        return 0.0
    visible = palette_of(colour[pixels[own, 1], pixels[own, 0]])
    same = float(np.sqrt(visible * palette).sum())  # Bhattacharyya 1943
    return min(1.0, same / SAME)
