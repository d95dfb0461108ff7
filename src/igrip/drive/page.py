"""The page of a device: hand, target, time left of the lease, state, and a big stop."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from importlib import resources
from typing import Any, get_args

from igrip.drive.loop import DriveLoop, Order
from igrip.runtime.page_server import HTML, JSON, PageServer

ORDERS = frozenset(get_args(Order)) - {"lost", "end"}


class DevicePage(PageServer):
    """Serves the page; ``/status`` is JSON, and a POST to ``/stop`` (or another order) is obeyed.

    Parameters
    ----------
    loop : DriveLoop
        Of the device.
    port : int
        On this machine only; 0: any that is free.
    extra : function
        Returns what else the page shows, such as the device's name.
    """

    def __init__(
        self, loop: DriveLoop, port: int, extra: Callable[[], dict[str, Any]] = dict
    ) -> None:
        html = resources.files("igrip.drive").joinpath("page.html").read_bytes()

        def obey(path: str, values: Mapping[str, Any]) -> bool:
            order = path.removeprefix("/")
            if order in ORDERS:
                loop.order(order)  # type: ignore[arg-type]
            return order in ORDERS

        pages = {
            "/": lambda: (HTML, html),
            "/status": lambda: (JSON, json.dumps(loop.status() | extra()).encode()),
        }
        super().__init__(pages, obey, port)
