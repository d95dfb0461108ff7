"""A browser for all tests of a file, and a recording of two hands whose every number is known."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from browser import CHROMIUM, FLAGS
from scripted_recording import snapshots_of


@pytest.fixture(scope="module")
def chromium():
    """A browser; the test is skipped without one."""
    if CHROMIUM is None:
        pytest.skip("no chromium: 'make system' installs it")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def snapshots(shapes):
    """The scripted recording."""
    return snapshots_of(shapes)


@pytest.fixture(scope="module")
def shown(chromium, snapshots):
    """The scripted recording on a page; ``go`` shows a moment and waits until it is drawn."""
    pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")
    from igrip.viewer.server import Viewer

    viewer = Viewer(port=0, targets="bayes", choose_targets=lambda name: None,
                    on_command=lambda command: commands.append(command))  # fmt: skip
    commands: list = []
    viewer.set_up(mode="recording")
    viewer.publish("player", {"begin": snapshots[0].t, "end": snapshots[-1].t, "playing": False,
                              "speed": 1.0, "repeat": False})  # fmt: skip
    viewer.note("", "scripted")
    viewer.show_recording(snapshots)
    page = chromium.new_page(viewport={"width": 1280, "height": 1000})
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
    page.add_init_script(RECORD_TEXTS)
    page.goto(viewer.url)

    def go(k):
        viewer.show_moment(snapshots[k])
        page.wait_for_function(
            "(t) => Math.abs((igrip.store.scene?.t ?? -9) - t) < 1e-4 && igrip.settled()",
            arg=snapshots[k].t,
        )
        return {hand.intention.hand: hand.intention for hand in snapshots[k].hands}

    yield SimpleNamespace(page=page, viewer=viewer, go=go, commands=commands)
    page.close()
    viewer.close()
    assert errors == []


RECORD_TEXTS = """
const clear = CanvasRenderingContext2D.prototype.clearRect
const fill = CanvasRenderingContext2D.prototype.fillText
CanvasRenderingContext2D.prototype.clearRect = function (...box) {
  this.canvas.texts = []
  return clear.apply(this, box)
}
CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
  const m = this.measureText(text)
  this.canvas.texts?.push({ text, left: x - m.actualBoundingBoxLeft,
    right: x + m.actualBoundingBoxRight, top: y - m.actualBoundingBoxAscent,
    bottom: y + m.actualBoundingBoxDescent })
  return fill.call(this, text, x, y, ...rest)
}
"""
