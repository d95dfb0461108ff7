"""Make the pictures of the documentation: ``make pictures`` (after ``make system``)."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from igrip import Estimator, load_objects
from igrip.simulation.demo import DemoPerson
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, rays_of, take_snapshot

FOLDER = Path(__file__).parent / "pictures"
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--ignore-gpu-blocklist", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip


def most_telling(seed: int = 0) -> tuple[Estimator, Snapshot, str]:
    """Return the moment of the demo's first reaches with the most impacts on the right target."""
    catalog = load_objects("ycb")
    estimator, person = Estimator(catalog), DemoPerson(catalog, seed)
    best: tuple[int, Snapshot | None, str] = (0, None, "")
    for moment in person:
        if moment.observation.t > 30.0:
            break
        snapshot = take_snapshot(estimator, estimator.update(moment.observation))
        for hand in snapshot.hands if snapshot else ():
            intention = hand.intention
            task, t = moment.task, moment.observation.t
            right = (intention.hand, intention.target) == (task.hand, task.target)
            if not (right and intention.status == "reaching" and task.onset < t < task.end):
                continue
            early = 0.05 < (intention.time_to_contact or 0.0) < 0.4
            impacts = len(rays_of(estimator.scene, hand)[1])
            if early and impacts > best[0]:
                best = impacts, snapshot, f"{task.hand} hand to {task.target}, {task.grip} grip"
    assert best[1] is not None
    return estimator, best[1], best[2]


def photograph(page: Page, viewer: Viewer, name: str) -> None:
    """Wait until the scene is drawn, put away the browser's remark on its GPU, and take it."""
    page.goto(viewer.url)
    page.get_by_text("reaches for").wait_for()
    page.wait_for_timeout(6000)  # software rendering
    for close in page.get_by_role("button").all():
        if close.is_visible() and not close.inner_text():
            box = close.bounding_box()
            if box and box["x"] < 400:
                close.click()
    page.wait_for_timeout(2500)
    page.screenshot(path=FOLDER / name)


def main() -> None:
    """Write all pictures."""
    FOLDER.mkdir(exist_ok=True)
    estimator, snapshot, words = most_telling()
    viewer = Viewer(estimator.scene)
    viewer.note(f"### Task\n{words}")
    viewer.show(snapshot)
    time.sleep(1.0)
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 720})
        photograph(page, viewer, "demo.png")
        browser.close()
    viewer.close()


if __name__ == "__main__":
    main()
