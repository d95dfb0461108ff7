"""The camera's picture on the page."""

from __future__ import annotations

import time

import numpy as np
import pytest

from browser import needs_chromium, open_page
from igrip.rgbd import Intrinsics, RgbdFrame
from igrip.viewer.camera_panel import CameraPanel, CameraView
from igrip.viewer.server import Viewer

pytest.importorskip("viser", reason="the extra 'viewer' is not installed")


def views(value):
    picture = np.full((60, 80, 3), value, np.uint8)
    camera = Intrinsics(80, 60, 60.0, 60.0, 39.5, 29.5)
    return {"desk": CameraView(RgbdFrame(0.0, picture, None, camera), {}, [], [])}


@needs_chromium
def test_it_stands_beside_the_scene_and_never_waits():
    viewer = Viewer(port=8533)
    panel = CameraPanel(viewer.server)
    try:
        begin = time.perf_counter()
        for k in range(300):
            panel.show(views(k % 200))
        panel.set_table("| stage |\n| --- |\n| desk: hands |")
        assert time.perf_counter() - begin < 1.0
        with open_page(viewer.url) as page:
            page.get_by_text("desk: hands").first.wait_for(timeout=30_000)
            page.locator("img[src^='blob:'], img[src^='data:image/jpeg']").first.wait_for(
                timeout=30_000
            )
        assert 1 <= panel.drawn < 300
    finally:
        panel.close()
        viewer.close()
