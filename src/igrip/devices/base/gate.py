"""The last check of a current: in the bytes that are about to leave for a stimulator.

It decodes what a vendor's library has built, by itself. Whatever went wrong before, a packet with
a current above the limit is not written.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from igrip.devices.base.device import DeviceError
from igrip.devices.base.limits import CurrentLimitError, checked

Largest = Callable[[bytes], tuple[float, float]]


class Gate:
    """A serial port that refuses to write currents and widths above a limit.

    Parameters
    ----------
    port
        An open ``serial.Serial``; all else is left to it.
    largest : function
        Returns the largest current [mA] and width [µs] in a packet.
    max_current, max_width : float
        What may pass.
    """

    def __init__(self, port: Any, largest: Largest, max_current: float, max_width: float) -> None:
        self._port, self._largest = port, largest
        self._max_current, self._max_width = max_current, max_width

    def write(self, data: bytes) -> Any:
        """Write a packet.

        Raises
        ------
        DeviceError
            If it is beyond a limit, or cannot be written.
        """
        current, width = self._largest(bytes(data))
        try:
            checked(current, self._max_current, "current", "mA")
            checked(width, self._max_width, "width", "µs")
        except CurrentLimitError as error:
            raise DeviceError(f"refused to send: {error}") from error
        return self._port.write(data)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._port, name)
