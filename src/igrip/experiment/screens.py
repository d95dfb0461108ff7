"""Two screens in the browser: ``/participant``, and ``/`` for the experimenter."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import partial
from importlib import resources
from typing import Any

from igrip.experiment.conductor import Conductor
from igrip.runtime.page_server import HTML, JPEG, JSON, PNG, Answer, PageServer


class Screens(PageServer):
    """Serves both screens.

    Parameters
    ----------
    conductor : Conductor
        Knows what they show, and takes the experimenter's orders.
    pictures : mapping of str to bytes
        PNG of each object, by id.
    camera_picture : function
        Returns what a camera sees now as JPEG, by its name; None: it has no picture.
    port, host, token
        As of :class:`igrip.runtime.page_server.PageServer`.
    """

    def __init__(
        self, conductor: Conductor, pictures: Mapping[str, bytes],
        camera_picture: Callable[[str], bytes | None], port: int, host: str = "127.0.0.1",
        token: str | None = None,
    ) -> None:  # fmt: skip
        static = resources.files(__package__).joinpath("pages")

        def page(name: str) -> tuple[str, bytes]:
            return HTML, static.joinpath(name).read_bytes()

        def order(path: str, values: Mapping[str, Any]) -> bool:
            return conductor.order(path.removeprefix("/"), str(values.get("text", "")))

        pages: dict[str, Callable[[], Answer]] = {
            "/": lambda: page("experimenter.html"),
            "/participant": lambda: page("participant.html"),
            "/status": lambda: (JSON, json.dumps(conductor.experimenter_screen()).encode()),
            "/shown": lambda: (JSON, json.dumps(conductor.participant_screen()).encode()),
        }
        for id, data in pictures.items():
            pages[f"/picture/{id}"] = partial(_picture, data)

        def find(path: str) -> Answer | None:
            kind, _, name = path.removeprefix("/").partition("/")
            data = camera_picture(name) if kind == "camera" and name in cameras else None
            return None if data is None else (JPEG, data)

        cameras = conductor.cameras
        super().__init__(pages, order, port, host, token, find)


def _picture(data: bytes) -> Answer:
    return PNG, data
