"""The page in a real browser, and that it never slows the estimator."""

import re
import shutil
import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from igrip import Estimator, load_objects
from igrip.simulation.demo import DemoPerson
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, rays_of, take_snapshot

pytest.importorskip("viser", reason="the extra 'viewer' is not installed")
CHROMIUM = shutil.which("chromium")
FLAGS = [
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--no-first-run", "--disable-quic",
]  # fmt: skip


def reaching() -> tuple[Estimator, Snapshot]:
    """Run the demo until a hand reaches with rays that meet its target."""
    catalog = load_objects("ycb")
    estimator = Estimator(catalog)
    for moment in islice(DemoPerson(catalog, 0), 200):
        snapshot = take_snapshot(estimator, estimator.update(moment.observation))
        assert snapshot is not None
        for hand in snapshot.hands:
            if hand.intention.status == "reaching" and len(rays_of(estimator.scene, hand)[1]) > 20:
                return estimator, snapshot
    raise AssertionError("no such moment")


@pytest.fixture
def viewer() -> Iterator[tuple[Viewer, Snapshot]]:
    estimator, snapshot = reaching()
    viewer = Viewer(estimator.scene, port=8471)
    yield viewer, snapshot
    viewer.close()


def test_rays_are_those_that_were_counted() -> None:
    estimator, snapshot = reaching()
    for hand in snapshot.hands:
        if hand.motion is None or hand.target is None or hand.intention.status != "reaching":
            continue
        geometry = estimator.scene.measure([hand.motion], snapshot.objects)[0]
        index = [placed.id for placed in snapshot.objects].index(hand.target.id)
        segments, impacts = rays_of(estimator.scene, hand)
        assert len(impacts) == geometry.hits[index] > 20
        assert len(segments) == 360
        # every impact lies on the mesh: no further from a vertex than its longest edge
        model = hand.target.model
        local = (impacts - hand.target.translation) @ hand.target.rotation
        away = np.linalg.norm(local[:, None] - model.vertices[None], axis=2).min(axis=1)
        corners = model.vertices[model.faces]
        assert away.max() < np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()


def test_show_never_waits(viewer: tuple[Viewer, Snapshot]) -> None:
    page, snapshot = viewer
    for _ in range(2000):
        page.show(snapshot)
    deadline = time.monotonic() + 20
    while page._newest is not None and time.monotonic() < deadline:
        time.sleep(0.01)
    assert page.dropped > 0
    assert page.dropped + page.drawn == pytest.approx(2000, abs=1)  # the last may still be drawn


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium: 'make system' installs it")
def test_what_is_on_the_page(viewer: tuple[Viewer, Snapshot], tmp_path: Path) -> None:
    from playwright.sync_api import sync_playwright

    shown, snapshot = viewer
    shown.note("### Task\nleft hand to soup")
    shown.show(snapshot)
    reaching = next(h for h in snapshot.hands if h.intention.status == "reaching")
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 1000, "height": 700})
        page.goto(shown.url)
        page.get_by_text(re.compile(f"reaches for {reaching.intention.target}")).wait_for()
        text = page.inner_text("body")
        assert "left hand to soup" in text
        assert f"{reaching.intention.grip} grip" in text
        green = 0
        deadline = time.monotonic() + 60
        while green < 300 and time.monotonic() < deadline:  # software rendering is slow to begin
            page.wait_for_timeout(500)
            page.screenshot(path=tmp_path / "page.png")
            green = target_pixels(tmp_path / "page.png")
        browser.close()
    assert green >= 300, "the target is not drawn in its colour"


def target_pixels(path: Path) -> int:
    """Count pixels of the hue of the target's colour."""
    from PIL import Image

    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    return int(((green > 1.8 * red) & (green > 1.5 * blue) & (green > 60)).sum())
