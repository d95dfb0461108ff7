"""Tracks of bodies in one recorded take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.frames import DeclaredFrame

Array = NDArray[np.float64]
MAX_INTERVAL_FACTOR = 1.5  # of the median interval: a longer one is a gap


@dataclass(frozen=True)
class Track:
    """One body in time, in igrip's world.

    Attributes
    ----------
    times : (n,)
        When it was seen [s], increasing.
    positions : (n, 3)
        Where [m].
    orientations : (n, 4) or None
        World-from-body rotations, unit quaternions x, y, z, w; None for a marker.
    lost : (m,)
        When it was looked for and not seen [s].

    Raises
    ------
    DatasetError
        If the times do not increase, shapes do not agree, or a number is not finite.
    """

    times: Array
    positions: Array
    orientations: Array | None = None
    lost: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not np.isfinite(self.times).all() or not (np.diff(self.times) > 0).all():
            raise DatasetError("the times of a track do not increase")
        if self.positions.shape != (len(self.times), 3) or not np.isfinite(self.positions).all():
            raise DatasetError("the positions of a track are not one finite triple for each time")
        turns = self.orientations
        if turns is not None and (
            turns.shape != (len(self.times), 4)
            or not (np.abs(np.linalg.norm(turns, axis=1) - 1.0) < 1e-3).all()
        ):
            raise DatasetError("the orientations of a track are not unit quaternions")

    def in_gap(self, times: Array, interval: float, rate: float) -> NDArray[np.bool_]:
        """Return which times of a new rate [Hz] lie in gaps.

        There, no sample is within 1.5 of the recording's intervals [s], or of the body's own where
        that is longer; or none within half a new interval, and the body is known to be lost at the
        nearest time. Interpolation over a gap would show an estimator where the body is going to
        reappear.
        """
        seen, lost = _distance(times, self.times), _distance(times, self.lost)
        half = 0.5 / rate * (1.0 + 1e-6)
        if len(self.times) > 2:
            interval = max(interval, float(np.median(np.diff(self.times))))
        return (seen > MAX_INTERVAL_FACTOR * interval) | ((lost < seen) & (seen > half))


def _distance(times: Array, samples: Array) -> Array:
    """Return the distance of each time to the nearest sample; infinite without any."""
    if not len(samples):
        return np.full(len(times), np.inf)
    after = np.searchsorted(samples, times)
    before = np.abs(times - samples[np.clip(after - 1, 0, None)])
    return np.minimum(before, np.abs(samples[np.clip(after, None, len(samples) - 1)] - times))


@dataclass(frozen=True)
class Take:
    """What one file, or one part of it, holds.

    Attributes
    ----------
    name : str
        Of the take.
    layout : str
        What the file was recognised as.
    tracks : mapping of str to Track
        What moves, by name.
    kinds : mapping of str to str
        ``marker``, ``rigid body``, …
    times : (n,)
        All times of the take [s], 0 at its beginning.
    interval : float
        Median step between them [s].
    frame : DeclaredFrame
        What was converted.
    gaps : mapping of str to int
        How many samples of each body are missing.
    remarks : sequence of str
        For the user.
    """

    name: str
    layout: str
    tracks: Mapping[str, Track]
    kinds: Mapping[str, str]
    times: Array
    interval: float
    frame: DeclaredFrame
    gaps: Mapping[str, int] = field(default_factory=dict)
    remarks: Sequence[str] = ()

    @property
    def seconds(self) -> float:
        """Length of the take [s]."""
        return float(self.times[-1] - self.times[0]) if len(self.times) else 0.0
