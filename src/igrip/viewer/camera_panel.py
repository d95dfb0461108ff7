"""The cameras' pictures beside the scene, drawn in a thread of their own, newest first."""

from __future__ import annotations

import logging
import threading
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.runtime.mailbox import Mailbox
from igrip.viewer.overlay import CameraView, draw_overlay

log = logging.getLogger(__name__)
INTERVAL = 0.1  # s between two pictures: a page needs no more, and encoding takes time of a core


class CameraPanel:
    """Pictures of one or several cameras on the page of a viser server, above a table."""

    def __init__(self, server: Any) -> None:
        self._gui = server.gui
        self._images: dict[str, Any] = {}
        self._views: Mailbox[dict[str, CameraView]] = Mailbox()
        self._table = self._gui.add_markdown("")
        self.drawn = 0
        self._thread = threading.Thread(target=self._run, name="igrip-picture", daemon=True)
        self._thread.start()

    def show(self, views: dict[str, CameraView]) -> None:
        """Show the newest view of each camera; never blocks."""
        self._views.put(views)

    def set_table(self, markdown: str) -> None:
        """Show a table below the pictures."""
        self._table.content = markdown

    def close(self) -> None:
        """Stop drawing."""
        self._views.close()
        self._thread.join(2.0)

    def _run(self) -> None:
        while not self._views.finished:
            views = self._views.get()
            if views is None:
                continue
            try:
                for camera, view in sorted(views.items()):
                    self._draw(camera, draw_overlay(view))
                self.drawn += 1
            except Exception:  # a picture that cannot be drawn must not end the page
                log.exception("a picture was not drawn")
            time.sleep(INTERVAL)

    def _draw(self, camera: str, picture: NDArray[np.uint8]) -> None:
        if camera not in self._images:
            self._images[camera] = self._gui.add_image(picture, label=camera, format="jpeg")
        else:
            self._images[camera].image = picture
