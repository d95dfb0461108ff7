"""Limits of stimulation that no configuration and no command can exceed.

They are in the code, not in a file, so that a mistyped file cannot raise them. Each current is
checked three times: when the configuration is read, before each command, and in the bytes that are
about to leave (:mod:`igrip.devices.base.gate`).
"""

from __future__ import annotations

import math

from igrip.errors import IgripError

MAX_CURRENT = 40.0  # mA; forearm stimulation for grasping uses 5 to 30 mA (guess)
MAX_WIDTH = 400.0  # µs of each phase of a pulse (guess)
MAX_FREQUENCY = 50.0  # Hz (guess)


class CurrentLimitError(IgripError, ValueError):
    """A current, width or frequency lies beyond a limit."""


def checked(value: float, limit: float, what: str, unit: str) -> float:
    """Return a value in [0, limit].

    Raises
    ------
    CurrentLimitError
        If it is not a number, negative or above the limit.
    """
    if not math.isfinite(value) or value < 0.0:
        raise CurrentLimitError(f"{what}: {value} {unit} is no {what}")
    if value > limit:
        raise CurrentLimitError(f"{what}: {value:g} {unit} is above the limit of {limit:g} {unit}")
    return value
