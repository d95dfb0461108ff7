"""The camera's picture on the page beside the scene, drawn in its own thread, newest first."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.rgbd import RgbdFrame
from igrip.runtime.mailbox import Mailbox
from igrip.viewer.overlay import draw_overlay

log = logging.getLogger(__name__)
EVERY = 0.1  # s between two pictures: pages need no more, and encoding takes a core's time


class Seen(NamedTuple):
    """What a picture is drawn from; see :func:`igrip.viewer.overlay.draw_overlay`."""

    frame: RgbdFrame
    landmarks: Mapping[str, NDArray[np.float64]]
    objects: Sequence[PlacedObject]
    intentions: Sequence[Intention]


class PicturePanel:
    """Pictures of one or several cameras on a page, and a table of the stages' rates and ages.

    Parameters
    ----------
    server : viser server
        Of the page.
    """

    def __init__(self, server: Any) -> None:
        self._gui = server.gui
        self._panels: dict[str, Any] = {}
        self._waiting: Mailbox[dict[str, Seen]] = Mailbox()
        self._table = self._gui.add_markdown("")
        self.drawn = 0
        self._thread = threading.Thread(target=self._run, name="igrip-picture", daemon=True)
        self._thread.start()

    def show(self, seen: dict[str, Seen]) -> None:
        """Hand over what each camera saw; returns at once."""
        self._waiting.put(seen)

    def tell(self, table: str) -> None:
        """Show a text under the pictures."""
        self._table.content = table

    def close(self) -> None:
        """Draw no more."""
        self._waiting.close()
        self._thread.join(2.0)

    def _run(self) -> None:
        while not self._waiting.finished:
            seen = self._waiting.get()
            if seen is None:
                continue
            try:
                for camera, one in sorted(seen.items()):
                    self._draw(camera, draw_overlay(*one))
                self.drawn += 1
            except Exception:  # a picture that cannot be drawn must not end the page
                log.exception("a picture was not drawn")
            time.sleep(EVERY)

    def _draw(self, camera: str, picture: NDArray[np.uint8]) -> None:
        if camera not in self._panels:
            self._panels[camera] = self._gui.add_image(picture, label=camera, format="jpeg")
        else:
            self._panels[camera].image = picture
