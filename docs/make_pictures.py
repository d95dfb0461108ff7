"""Draw the pictures of the documentation: ``make pictures`` (after ``make system``)."""

from __future__ import annotations

import shutil
from pathlib import Path

import cv2
from playwright.sync_api import Page, sync_playwright

from igrip import Config, Estimator, load_objects
from igrip.lab.simulation.demo import DemoPerson
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.perception.cameras.rendered import RenderedCamera
from igrip.perception.pipeline.merge import DetectedHands
from igrip.perception.pipeline.stages import hand_stages, object_stages
from igrip.perception.pipeline.synchronous import observe
from igrip.rgbd import RgbdFrame
from igrip.viewer.grip_page import GripPage
from igrip.viewer.overlay import CameraView, draw_overlay
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, rays_of, take_snapshot

FOLDER = Path(__file__).parent / "pictures"
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--ignore-gpu-blocklist", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip


def clearest_moment(seed: int = 0) -> tuple[list[Snapshot], str]:
    """Return the demo up to the earliest moment at which the rays meet the right target."""
    catalog = load_objects("ycb")
    estimator, person = Estimator(catalog), DemoPerson(catalog, seed)
    moments: list[Snapshot] = []
    earliest, index, task_text = 0.0, 0, ""
    for moment in person:
        if moment.observation.t > 40.0:
            break
        estimator.update(moment.observation)
        snapshot = take_snapshot(estimator)
        moments.append(snapshot)
        for hand in snapshot.hands:
            intention = hand.intention
            task, t = moment.task, moment.observation.t
            right = (intention.hand, intention.target) == (task.hand, task.target)
            if not (right and intention.status == "reaching" and task.onset < t < task.end):
                continue
            hits, misses = rays_of(snapshot.scene, hand)
            pointed = len(hits) > 0.3 * (len(hits) + len(misses))
            time_left = intention.time_to_contact or 0.0
            if t > 8.0 and pointed and time_left > earliest:  # by then the time courses are long
                earliest, index = time_left, len(moments)
                task_text = f"{task.hand} hand to {task.target}, {task.grip} grip"
    assert earliest > 0
    return moments[:index], task_text


def show_last(viewer: Viewer, moments: list[Snapshot]) -> None:
    """Show moments as a recording that stands at its end."""
    viewer.set_up(mode="recording")
    viewer.publish("player", {"begin": moments[0].t, "end": moments[-1].t, "playing": False,
                              "speed": 1.0, "repeat": False})  # fmt: skip
    viewer.show_recording(moments)
    viewer.show_moment(moments[-1])


def photograph(page: Page, url: str, text: str, name: str) -> None:
    """Wait until all is drawn, and take a screenshot."""
    page.goto(url)
    page.get_by_text(text).first.wait_for()
    page.wait_for_function(
        "() => igrip.settled() && !igrip.scene.camera.goal && igrip.scene.meshes.size"
        " && [...igrip.scene.meshes.values()].every(Boolean)"
    )
    page.screenshot(path=FOLDER / name)


def live_picture(name: str, seed: int = 1) -> None:
    """Draw what the pipeline detects and decides in a rendered reach, where it is surest."""
    catalog = load_objects("ycb")
    camera = RenderedCamera(seed)
    find_hands = hand_stages("mediapipe", 2)()
    find_objects = object_stages("depth", catalog, {"models": PAPER_OBJECTS})()
    estimator = Estimator(catalog)
    detections: list[DetectedHands] = []

    def hands(frame: RgbdFrame) -> DetectedHands:
        detections.append(find_hands(frame))
        return detections[-1]

    frames = (camera.frame(k / 30.0) for k in range(120))
    best, picture = 0.0, None
    for message in observe(frames, hands, find_objects):
        for intention in estimator.update(message):
            confidence, latest = intention.confidence or 0.0, detections[-1]
            if intention.status == "reaching" and confidence > best and latest.landmarks:
                intentions = list(estimator.latest.values())
                best, picture = confidence, draw_overlay(
                    CameraView(latest.frame, latest.landmarks, estimator.objects, intentions)
                )  # fmt: skip
    find_hands.close()
    assert picture is not None, "no hand reaches in these frames"
    cv2.imwrite(str(FOLDER / name), picture[..., ::-1])


def main() -> None:
    """Write all pictures."""
    live_picture("live.png")
    FOLDER.mkdir(exist_ok=True)
    moments, task_text = clearest_moment()
    viewer = Viewer(port=0, targets=Config().targets, choose_targets=lambda name: None)
    viewer.note("Task", task_text)
    show_last(viewer, moments)
    catalog = load_objects("ycb")
    zones = GripPage([catalog[name] for name in PAPER_OBJECTS], Config().grip.pinch_threshold,
                     port=0)  # fmt: skip
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1600, "height": 900})
        photograph(page, viewer.url, "reaches for", "demo.png")
        photograph(page, zones.url, "Grip by height", "grip_page.png")
        browser.close()
    viewer.close()
    zones.close()


if __name__ == "__main__":
    main()
