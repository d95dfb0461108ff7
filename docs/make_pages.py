"""Photograph every page of igrip at three widths: part of ``make pictures``.

The commands are those that a person types, but for ``live``, which a busy machine would starve;
the page is photographed at a moment with something to see.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from igrip import Config, Estimator, load_objects
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.perception.cameras.rendered import RenderedCamera
from igrip.perception.pipeline.merge import DetectedHands
from igrip.perception.pipeline.stages import hand_stages, object_stages
from igrip.perception.pipeline.synchronous import observe
from igrip.rgbd import RgbdFrame
from igrip.viewer.camera_panel import CameraPanel
from igrip.viewer.overlay import CameraView
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import take_snapshot

FOLDER = Path(__file__).parent / "pictures" / "pages"
SIZES = {1920: 1080, 820: 1180, 390: 844}  # pixels, width to height
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--ignore-gpu-blocklist", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip
REPORTED = ("--targets", "paper", "--targets", "bayes", "--targets", "distance")
PATIENCE = 180.0  # s
SECONDS = 9.0  # of a live scene before it is photographed, so that its charts have a history


@contextmanager
def served(*arguments: object) -> Iterator[str]:
    """Run a command that serves a page; yield the address; end it."""
    command = [sys.executable, "-m", "igrip", *map(str, arguments)]
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    ) as process:
        assert process.stderr is not None
        try:
            found = (re.search(r"http://localhost:\d+", line) for line in process.stderr)
            yield next(match for match in found if match)[0]
        finally:
            process.terminate()  # a job in the background ignores Ctrl-C


def reaches(page: Page) -> bool:
    """Whether a hand reaches for something, after a while."""
    return bool(page.evaluate(
        "(after) => igrip.store.scene?.t > after && document.querySelector('.card.sure')", SECONDS
    ))  # fmt: skip


def photograph_live(page: Page, name: str) -> None:
    """Photograph a scene in motion while a hand reaches, before and after the shutter."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if reaches(page):
            page.screenshot(path=FOLDER / name)
            if reaches(page):
                return
        page.wait_for_timeout(30)
    raise AssertionError(f"{name}: no such moment")


@contextmanager
def live_page() -> Iterator[str]:
    """Show what ``igrip live --camera rendered`` does, each frame of it however slow the machine.

    It stays at the surest moment of a reach.
    """
    catalog, camera = load_objects("ycb"), RenderedCamera(1)
    find_hands = hand_stages("mediapipe", 2)()
    find_objects = object_stages("depth", catalog, {"models": PAPER_OBJECTS})()
    estimator, viewer = Estimator(catalog), Viewer(port=0, targets=Config().targets)
    panel = CameraPanel(viewer)
    detections: list[DetectedHands] = []

    def hands(frame: RgbdFrame) -> DetectedHands:
        detections.append(find_hands(frame))
        return detections[-1]

    surest, rows, best = 0.0, [], None
    for message in observe((camera.frame(k / 30.0) for k in range(120)), hands, find_objects):
        intentions, snapshot = estimator.update(message), take_snapshot(estimator)
        rows.append(snapshot)
        for intention in intentions:
            sure = intention.confidence or 0.0
            if intention.status == "reaching" and sure > surest and detections[-1].landmarks:
                newest = list(estimator.latest.values())
                view = CameraView(detections[-1].frame, detections[-1].landmarks,
                                  estimator.objects, newest)  # fmt: skip
                surest, best = sure, (len(rows), view)
    find_hands.close()
    assert best is not None, "no hand reaches in these frames"
    for snapshot in rows[: best[0]]:
        viewer.show(snapshot)
    done = threading.Event()

    def keep_on() -> None:  # or the countdown of the lease would end
        while not done.wait(0.05):
            viewer.show_moment(rows[best[0] - 1])

    thread = threading.Thread(target=keep_on)
    thread.start()
    panel.show({"rendered": best[1]})
    yield viewer.url
    done.set()
    thread.join()
    panel.close()
    viewer.close()


def photograph_recording(page: Page, name: str) -> None:
    """Photograph the middle of the first lease of a recording."""
    page.locator("#play").wait_for()
    times = page.evaluate(
        "[...igrip.store.rows.values()].flat().filter((row) => row.lease).map((row) => row.t)"
    )
    middle = times[len(times) // 2]
    page.evaluate(
        "(t) => { const s = document.getElementById('slider'); s.value = t;"
        " s.dispatchEvent(new Event('input')) }", middle,
    )  # fmt: skip
    page.locator(".card.permitted").first.wait_for()
    page.wait_for_timeout(3000)
    page.screenshot(path=FOLDER / name)


def photograph_still(page: Page, name: str) -> None:
    """Photograph a page on which nothing moves."""
    page.wait_for_timeout(3000)
    page.screenshot(path=FOLDER / name)


def at_each_width(browser: Browser, url: str, name: str, shot: Callable[[Page, str], None]) -> None:
    """Photograph an address in windows of each width."""
    for width, height in SIZES.items():
        page = browser.new_page(viewport={"width": width, "height": height})
        page.goto(url)
        shot(page, f"{name}-{width}.png")
        page.close()


def main(names: list[str]) -> None:
    """Photograph the pages with these names; all, if there are none."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    chosen = set(names) or {"demo", "live", "view", "grips", "report"}
    with sync_playwright() as play, tempfile.TemporaryDirectory() as folder:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        cohort, report = Path(folder) / "cohort", Path(folder) / "report"
        if chosen & {"view", "report"}:
            igrip(folder, "simulate", "cohort", "--participants", 3, "--trials", 4, "--no-reach", 1)
        if "demo" in chosen:
            with served("demo", "--port", 0, "--duration", 600) as url:
                at_each_width(browser, url, "demo", photograph_live)
        if "live" in chosen:
            with live_page() as url:
                at_each_width(browser, url, "live", photograph_still)
        if "view" in chosen:
            with served("view", cohort, "--trial", 3, "--port", 0) as url:
                at_each_width(browser, url, "view", photograph_recording)
        if "grips" in chosen:
            with served("grips", "--page", "--port", 0) as url:
                at_each_width(browser, url, "grips", photograph_still)
        if "report" in chosen:
            igrip(folder, "evaluate", "cohort", "--out", "report", *REPORTED)
            address = (report / "report.html").as_uri()
            at_each_width(browser, address, "report", photograph_still)
        browser.close()


def igrip(folder: str, *arguments: object) -> None:
    """Run a command to its end, in a folder, so that the report tells no path of this machine."""
    command = [sys.executable, "-m", "igrip", *map(str, arguments)]
    subprocess.run(command, check=True, cwd=folder)


if __name__ == "__main__":
    main(sys.argv[1:])
