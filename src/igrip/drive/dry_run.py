"""A device that only says what another one would do."""

from __future__ import annotations

from collections.abc import Callable

from igrip.devices.base.device import Cause, DeviceState, Permit

HOLDS_AFTER = 0.3  # s of closing


class DryRun:
    """Takes permits, opens no port, and reports the states of a device that is obeyed.

    Parameters
    ----------
    clock : function
        A monotonic clock [s].
    """

    min_interval = 0.02

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._permit: Permit | None = None
        self._closes_since: float | None = None

    def open(self) -> None:
        """Do nothing."""

    def allow(self, permit: Permit) -> None:
        """Remember it."""
        if permit.phase == "grasp" and self._closes_since is None:
            self._closes_since = self._clock()
        self._permit = permit

    def stop(self, cause: Cause = "end") -> None:
        """Forget it."""
        self._permit = self._closes_since = None

    def state(self) -> DeviceState:
        """Return what a device would report."""
        if self._permit is None:
            return DeviceState("open", "dry run: nothing is moved")
        since = self._closes_since
        held = since is not None and self._clock() - since >= HOLDS_AFTER
        return DeviceState("holding" if held else "closing", "dry run: nothing is moved")

    def keep_alive(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Forget everything."""
        self.stop("close")
