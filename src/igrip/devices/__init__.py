"""Devices that act on leases, by name: one module each, with a virtual twin in ``twins``."""

from __future__ import annotations

from typing import Any

from igrip.registry import Registry

# a member is a class of igrip.devices.base.device.Device, called with its settings and a clock; it
# has ``Settings``, and ``new_twin(settings, clock)`` returns its virtual twin
DEVICES: Registry[type[Any]] = Registry("device", "igrip.devices")


def device_name(text: str) -> str:
    """Return the name of a device as the registry spells it: ``ability-hand`` → ``ability_hand``.

    Raises
    ------
    UnknownNameError
        If there is no such device.
    """
    name = text.replace("-", "_").lower()
    DEVICES.check(name)
    return name
