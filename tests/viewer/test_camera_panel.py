"""The cameras' pictures on the page."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from browser import needs_chromium, open_page
from igrip.rgbd import Intrinsics, RgbdFrame
from igrip.viewer import camera_panel
from igrip.viewer.camera_panel import CameraPanel
from igrip.viewer.overlay import CameraView
from igrip.viewer.server import Viewer

pytest.importorskip("viser", reason="the extra 'viewer' is not installed")


def views(value):
    picture = np.full((60, 80, 3), value, np.uint8)
    camera = Intrinsics(80, 60, 60.0, 60.0, 39.5, 29.5)
    return {"desk": CameraView(RgbdFrame(0.0, picture, None, camera), {}, [], [])}


@pytest.fixture
def panel():
    viewer = Viewer(port=8533)
    panel = CameraPanel(viewer.server)
    panel.url = viewer.url
    yield panel
    panel.close()
    viewer.close()


def test_show_never_waits(panel, monkeypatch):
    """While a picture is drawn, newer ones replace each other; the newest is drawn next."""
    drawing, go_on, drawn = threading.Event(), threading.Event(), []

    def draw(view):
        drawn.append(int(view.frame.colour[0, 0, 0]))
        drawing.set()
        assert go_on.wait(60)
        return view.frame.colour

    monkeypatch.setattr(camera_panel, "draw_overlay", draw)
    panel.show(views(0))
    assert drawing.wait(60)
    for value in range(1, 200):
        panel.show(views(value))  # it would wait for ever
    go_on.set()
    deadline = time.monotonic() + 60
    while panel.drawn < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert drawn == [0, 199]


@pytest.mark.browser
@needs_chromium
def test_it_stands_beside_the_scene(panel):
    panel.show(views(100))
    panel.set_table("| stage |\n| --- |\n| desk: hands |")
    with open_page(panel.url) as page:
        page.get_by_text("desk: hands").first.wait_for(timeout=60_000)
        page.locator("img[src^='blob:'], img[src^='data:image/jpeg']").first.wait_for(
            timeout=60_000
        )
