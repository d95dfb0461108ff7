"""The cameras' pictures beside the scene, drawn in a thread of their own, newest first."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from igrip.errors import requires_extra
from igrip.runtime.mailbox import Mailbox
from igrip.viewer.overlay import CameraView, draw_overlay
from igrip.viewer.server import Viewer

log = logging.getLogger(__name__)
INTERVAL = 0.1  # s between two pictures: a page needs no more, and encoding takes time of a core
WIDTH = 960  # pixels
QUALITY = 85  # of a JPEG picture, of 100


class CameraPanel:
    """Pictures of one or several cameras on the page, and a table of the detectors below."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer
        self._views: Mailbox[dict[str, CameraView]] = Mailbox()
        self.drawn = 0
        self._thread = threading.Thread(target=self._run, name="igrip-picture", daemon=True)
        self._thread.start()

    def show(self, views: dict[str, CameraView]) -> None:
        """Show the newest view of each camera; never blocks."""
        self._views.put(views)

    def set_table(self, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Show a table of the stages."""
        self._viewer.publish("stages", {"columns": list(columns), "rows": [*map(list, rows)]})

    def close(self) -> None:
        """Stop drawing."""
        self._views.close()
        self._thread.join(2.0)

    def _run(self) -> None:
        while not self._views.finished:
            views = self._views.get()
            if views is None:
                continue
            looks = self._viewer.looks.numbers()
            try:
                for camera, view in sorted(views.items()):
                    self._publish(camera, draw_overlay(view, WIDTH, looks))
                self.drawn += 1
            except Exception:  # a picture that cannot be drawn must not end the page
                log.exception("a picture was not drawn")
            time.sleep(INTERVAL)

    def _publish(self, camera: str, picture: NDArray[np.uint8]) -> None:
        with requires_extra("opencv-python-headless", "hands", "the picture of a camera"):
            import cv2
        options = [cv2.IMWRITE_JPEG_QUALITY, QUALITY]
        _, data = cv2.imencode(".jpg", np.ascontiguousarray(picture[..., ::-1]), options)
        self._viewer.add_resource(f"/picture/{camera}", "image/jpeg", data.tobytes())
        self._viewer.publish("picture", {"camera": camera, "number": self.drawn}, key=camera)
