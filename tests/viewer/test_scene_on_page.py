"""The scene: targets are outlined, the camera fits and follows; pictures and films are saved."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

from browser import needs_chromium
from igrip.viewer.palette import INK, colour_of, rgb
from scripted_recording import DECIDED, OTHER, UNDECIDED

pytestmark = [pytest.mark.browser, needs_chromium]

PAINTED = """() => {
  const { scene, store } = window.igrip
  const found = []
  const draw = scene.renderer.drawMesh
  scene.renderer.drawMesh = (mesh, model, colour, grow) => {
    const id = store.scene.objects.find((one) => scene.meshes.get(one.mesh) === mesh).id
    found.push([id, colour, grow > 0])
    draw.call(scene.renderer, mesh, model, colour, grow)
  }
  scene.dirty = true
  scene.frame()
  scene.renderer.drawMesh = draw
  return found
}"""
ENDS = """() => {
  const m = window.igrip.scene.camera.matrix()
  const { objects, hands } = window.igrip.store.scene
  return [...objects.flatMap((one) => [one.centre, one.top]), ...hands.map((hand) => hand.position)]
    .map((p) => [0, 1, 3].map((k) => m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k]))
    .map(([x, y, w]) => [x / w, y / w, w])
}"""
AT_REST = """() => igrip.settled() && !igrip.scene.camera.goal
  && [...igrip.scene.meshes.values()].every(Boolean)"""


@pytest.fixture
def scene(shown):
    def go(k):
        shown.go(k)
        shown.page.wait_for_function(AT_REST)
        return shown.page

    return go


@pytest.mark.parametrize(
    ("moment", "targets"), [(UNDECIDED, []), (DECIDED, ["soup"]), (OTHER, ["left"])]
)
def test_the_target_is_outlined_and_keeps_its_colour(scene, moment, targets):
    painted = scene(moment).evaluate(PAINTED)
    assert [id for id, _, outline in painted if outline] == targets
    assert all(colour == INK for _, colour, outline in painted if outline)
    own = {id: colour for id, colour, outline in painted if not outline}
    assert own == {"left": colour_of(0), "soup": colour_of(1)}


def test_objects_called_left_are_not_taken_for_hands(scene):
    labels = scene(OTHER).evaluate("igrip.scene.drawnLabels")
    texts = {label["text"]: (bool(label.get("dark")), label.get("letter"), label["note"])
             for label in labels}  # fmt: skip
    assert texts == {
        "object “left”": (False, "A", "◀ Right hand"), "soup": (False, "B", ""),
        "Left hand": (True, None, ""), "Right hand": (True, None, ""),
    }  # fmt: skip


def test_all_is_in_the_picture_and_stays_there(scene, shown, snapshots):
    page = scene(OTHER)
    near = np.array(page.evaluate(ENDS))
    assert (np.abs(near[:, :2]) < 1.0).all()
    assert np.ptp(near[:, 0]) > 0.3  # nor is it a speck
    moment = snapshots[OTHER]
    away = [replace(hand, past=hand.past + [1.5, -0.8, 0.3]) for hand in moment.hands]
    shown.viewer.show_moment(replace(moment, t=moment.t + 0.01, hands=away))
    page.wait_for_function("(t) => igrip.store.scene.t > t + 0.005", arg=moment.t)
    page.wait_for_function(AT_REST)
    assert (np.abs(np.array(page.evaluate(ENDS))[:, :2]) < 1.0).all()


def test_a_person_may_take_the_camera_and_give_it_back(scene):
    page = scene(OTHER)
    before = page.evaluate("igrip.scene.camera.eye()")
    page.locator("#gl").focus()
    page.keyboard.press("ArrowLeft")
    turned = page.evaluate("igrip.scene.camera.eye()")
    assert turned != before
    assert page.evaluate("igrip.scene.camera.follow")  # turning leaves the centre
    page.keyboard.press("+")
    assert not page.get_by_label("Follow").is_checked()
    page.get_by_role("button", name="Fit view").click()
    page.wait_for_function(AT_REST)
    assert page.get_by_label("Follow").is_checked()
    assert (np.abs(np.array(page.evaluate(ENDS))[:, :2]) < 1.0).all()


def test_a_picture_is_saved(scene):
    from PIL import Image

    page = scene(DECIDED)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save picture").click()
    assert download.value.suggested_filename == f"igrip-{0.1 * DECIDED:.2f}s.png"
    with open(download.value.path(), "rb") as file:
        picture = np.asarray(Image.open(io.BytesIO(file.read())).convert("RGB")).astype(int)
    assert picture.shape == (720, 1280, 3)
    bars = picture[:, 880:]  # beside the scene: bars in the very colours
    for colour in (colour_of(0), colour_of(1), "#000000"):
        assert (np.abs(bars - rgb(colour)).sum(axis=2) == 0).sum() > 20, colour
    assert len(np.unique(picture[:, :880].reshape(-1, 3), axis=0)) > 100  # the scene, shaded


def test_a_film_is_saved(scene):
    page = scene(DECIDED)
    page.get_by_role("button", name="Record film").click()
    page.wait_for_function("() => parseInt(document.getElementById('film').title) > 2")
    with page.expect_download() as download:
        page.get_by_role("button", name="Stop and save film").click()
    assert download.value.suggested_filename.endswith(".webm")
    with open(download.value.path(), "rb") as file:
        film = file.read()
    assert film[:4] == b"\x1a\x45\xdf\xa3"  # EBML
    assert len(film) > 1000
    assert page.get_by_role("button", name="Record film").get_attribute("aria-pressed") == "false"
