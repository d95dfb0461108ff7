"""Devices that act on leases, by name: one module each, with a virtual twin in ``twins``."""

from __future__ import annotations

from igrip.devices.base.device import DeviceType
from igrip.registry import Registry

DEVICES: Registry[type[DeviceType]] = Registry("device", "igrip.devices")


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
