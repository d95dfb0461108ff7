"""``--device`` of ``igrip live`` and ``igrip demo``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from igrip.devices import DEVICES, device_name
from igrip.devices.base.settings import read_settings
from igrip.drive.process import DeviceProcess
from igrip.errors import IgripError
from igrip.runtime.protocol import Command


def device_process(
    device: str | None, config: Path | None, arm: bool, twin: bool, headless: bool,
    obey: Callable[[Command], None] | None = None,
) -> DeviceProcess | None:  # fmt: skip
    """Return the process of a device, not started yet; None: there is none.

    Raises
    ------
    IgripError
        If something is missing or wrong; before anything slow begins.
    """
    if device is None:
        if config is not None or arm or twin:
            raise IgripError("--device-config, --arm and --twin need --device")
        return None
    if config is None:
        raise IgripError("--device needs --device-config FILE: docs/devices.md")
    read_settings(DEVICES.get(device_name(device)).Settings, config)
    page = ["--headless"] if headless else ["--page-port", "0"]
    flags = [*(["--arm"] if arm else []), *(["--twin"] if twin else [])]
    return DeviceProcess(["--device", device, "--config", str(config), *page, *flags], obey)
