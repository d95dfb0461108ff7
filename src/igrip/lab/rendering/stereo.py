"""What a stereo camera makes of a true depth picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

from igrip.rgbd import Array
from igrip.settings import Settings, quantity


class StereoNoise(Settings):
    """How a stereo camera errs; by default about as an OAK-D S2 does at 640 pixels.

    The datasheet asks for less than 2 % of error below 4 m, which ``sd_disparity`` gives.
    """

    baseline: float = quantity(
        0.075, "m", "between the two cameras", "OAK-D S2, Luxonis datasheet", gt=0
    )
    sd_disparity: float = quantity(
        0.25, "pixels", "standard deviation of the disparity; that of the depth is z²/(f b) of it",
        "guess within the datasheet", ge=0,
    )  # fmt: skip
    correlation: float = quantity(
        1.5, "pixels", "over which errors are alike", "guess: half of a 5 x 5 census window", ge=0
    )
    step: float = quantity(
        0.03125, "pixels", "disparities are whole numbers of it", "depthai: 5 bits of sub-pixel",
        ge=0,
    )  # fmt: skip
    edge: float = quantity(
        0.7, "pixels", "standard deviation of where a depth edge is seen", "guess", ge=0
    )
    holes: float = quantity(0.01, "1", "share of pixels without depth, in spots", "guess", ge=0)
    spot: float = quantity(2.0, "pixels", "size of a spot without depth", "guess", gt=0)
    min_cosine: float = quantity(
        0.15, "1", "between surface and line of sight; at less no depth is measured", "guess", ge=0,
        lt=1,
    )  # fmt: skip
    min_depth: float = quantity(0.2, "m", "that is measured", "OAK-D S2 datasheet", ge=0)
    max_depth: float = quantity(8.0, "m", "that is measured", "guess", gt=0)


def measured_depth(
    depth: Array, cosine: Array, fx: float, noise: StereoNoise, random: np.random.Generator
) -> NDArray[np.float32]:
    """Return the depth that the camera measures, (h, w) [m]; 0 where there is none.

    Parameters
    ----------
    depth : (h, w)
        True depth along the optical axis [m]; infinity or 0 for nothing.
    cosine : (h, w)
        Between surface and line of sight; 1 for a surface that faces the camera.
    fx : float
        Focal length [pixels].
    """
    scale = fx * noise.baseline
    with np.errstate(divide="ignore"):
        disparity = np.where(depth > 0.0, scale / depth, 0.0)  # none at infinity
    hidden = occluded(disparity)
    if noise.edge > 0.0:
        rows, columns = np.indices(depth.shape, dtype=np.float64)
        shift = [noise.edge * _smooth(random, depth.shape, noise.correlation) for _ in range(2)]
        where = [rows + shift[0], columns + shift[1]]
        disparity = map_coordinates(disparity, where, order=0, mode="nearest")
    disparity = disparity + noise.sd_disparity * _smooth(random, depth.shape, noise.correlation)
    if noise.step > 0.0:
        disparity = noise.step * np.round(disparity / noise.step)
    spots = _smooth(random, depth.shape, noise.spot)
    lost = hidden | (cosine < noise.min_cosine)
    if noise.holes > 0.0:
        lost |= spots > np.quantile(spots, 1.0 - min(noise.holes, 1.0))
    with np.errstate(divide="ignore"):
        result = np.where(disparity > 0.0, scale / disparity, 0.0)
    lost |= (result < noise.min_depth) | (result > noise.max_depth)
    return np.where(lost, 0.0, result).astype(np.float32)


def occluded(disparity: Array) -> NDArray[np.bool_]:
    """Where the second camera, to the right, sees something nearer instead; shape (h, w)."""
    columns = np.arange(disparity.shape[1], dtype=np.float64)
    other = columns - disparity  # the column in the other picture
    nearest = np.minimum.accumulate(other[:, ::-1], axis=1)[:, ::-1]  # of all at the right of it
    result = np.zeros(disparity.shape, dtype=np.bool_)
    result[:, :-1] = other[:, :-1] > nearest[:, 1:] + 0.5
    return result


def _smooth(random: np.random.Generator, shape: tuple[int, ...], size: float) -> Array:
    """Return noise of standard deviation 1 that is alike over so many pixels."""
    noise: Array = random.standard_normal(shape)
    if size <= 0.0:
        return noise
    noise = np.asarray(gaussian_filter(noise, size, mode="wrap"))
    result: Array = noise * (2.0 * np.sqrt(np.pi) * size)  # a filter leaves 1 / (2 sqrt(pi) size)
    return result
