"""The clock of a camera, by the same model as that of any other sender."""

from __future__ import annotations

import math

from igrip.runtime.clock_offset import ClockOffset

AHEAD = 0.05  # s by which a frame may seem to come from the future; as GatingConfig's
SETTLED = 8  # frames, from which on the model knows their usual interval


class DeviceClock:
    """Follows the steps of a clock whose times should be those of this machine already.

    The vendor's software keeps a camera in step with this machine; the time from exposure to
    arrival is real and is kept. Where the clock is set, by any amount, frames are not used until
    several agree, and then go on from where they were.

    Parameters
    ----------
    name : str
        Of the camera, for texts.

    Attributes
    ----------
    problem : str or None
        Why times cannot be used at present.
    event : str or None
        The newest step that was followed.
    """

    def __init__(self, name: str) -> None:
        self._model = ClockOffset(name)
        self._offset, self._shift = math.nan, 0.0
        self._frames = 0
        self.event: str | None = None

    @property
    def problem(self) -> str | None:
        """Why times cannot be used at present; None: they can."""
        return self._model.distrust

    def update(self, t: float, arrived: float) -> float | None:
        """Return the time of a frame on this machine's clock [s]; None where it is not known."""
        if t > arrived + AHEAD and self._frames < SETTLED:
            return None  # no interval tells yet whether the clock was set or this time is odd
        self._frames += 1
        steps = self._model.counts["steps"]
        offset = self._model.update(t, arrived)
        change, self._offset = offset - self._offset, offset
        if self._model.counts["steps"] > steps:
            self._shift += change
            self.event = self._model.event
        if self._model.distrust is not None:
            return None
        return t + self._shift
