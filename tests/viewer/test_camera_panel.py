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

pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")


def views(value):
    picture = np.full((60, 80, 3), value, np.uint8)
    camera = Intrinsics(80, 60, 60.0, 60.0, 39.5, 29.5)
    return {"desk": CameraView(RgbdFrame(0.0, picture, None, camera), {}, [], [])}


@pytest.fixture
def panel():
    viewer = Viewer(port=0)
    panel = CameraPanel(viewer)
    panel.url = viewer.url
    yield panel
    panel.close()
    viewer.close()


def test_show_never_waits(panel, monkeypatch):
    """While a picture is drawn, newer ones replace each other; the newest is drawn next."""
    drawing, go_on, drawn = threading.Event(), threading.Event(), []

    def draw(view, width, looks):
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
def test_it_stands_large_beside_the_scene_at_1080p(panel):
    panel.show(views(100))
    panel.set_table(["stage"], [["desk: hands"]])
    with open_page(panel.url, 1920, 1080) as page:
        page.locator("#cameras img").wait_for(timeout=60_000)
        page.wait_for_function("document.querySelector('#cameras img').naturalWidth > 0")
        assert page.locator("#stages td, #stages th").last.text_content() == "desk: hands"
        picture, scene = (page.locator(name).bounding_box() for name in ("#cameras", "#scene"))
        assert picture["width"] > 700
        assert scene["width"] > 500
        assert picture["x"] + picture["width"] <= scene["x"]  # beside each other
        assert scene["y"] < picture["y"] + picture["height"]
        assert max(picture["y"] + picture["height"], scene["y"] + scene["height"]) <= 1080
        colour = page.evaluate(MIDDLE)
        assert all(abs(value - 100) < 6 for value in colour)  # the picture, not another


MIDDLE = """() => {
  const image = document.querySelector('#cameras img')
  const canvas = document.createElement('canvas')
  Object.assign(canvas, { width: 1, height: 1 })
  canvas.getContext('2d').drawImage(image, 0, 0, 1, 1)
  return [...canvas.getContext('2d').getImageData(0, 0, 1, 1).data].slice(0, 3)
}"""
