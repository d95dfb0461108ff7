"""The page in a real browser, and that it never slows the estimator."""

import re
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from browser import needs_chromium, open_page
from igrip import load_objects
from igrip.viewer.server import Viewer
from igrip.viewer.snapshot import Snapshot, rays_of
from moments import demo_moments

pytest.importorskip("viser", reason="the extra 'viewer' is not installed")


@pytest.fixture(scope="module")
def moments() -> list[Snapshot]:
    """The demo until a hand reaches with rays that meet its target."""
    return demo_moments(load_objects("ycb"))


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    viewer = Viewer(port=8471, targets="repaired", choose_targets=lambda name: None)
    yield viewer
    viewer.close()


def test_rays_are_those_that_were_counted(moments: list[Snapshot]) -> None:
    moment = moments[-1]
    for hand in moment.hands:
        if hand.motion is None or hand.target is None or hand.intention.status != "reaching":
            continue
        geometry = moment.scene.measure([hand.motion], moment.objects)[0]
        index = [placed.id for placed in moment.objects].index(hand.target.id)
        hits, misses = rays_of(moment.scene, hand)
        assert len(hits) == geometry.hits[index] > 20
        assert len(hits) + len(misses) == 360
        # every impact lies on the mesh: no further from a vertex than its longest edge
        model = hand.target.model
        local = (hits[:, 1] - hand.target.translation) @ hand.target.rotation
        away = np.linalg.norm(local[:, None] - model.vertices[None], axis=2).min(axis=1)
        corners = model.vertices[model.faces]
        assert away.max() < np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()


def test_show_never_waits(viewer: Viewer, moments: list[Snapshot]) -> None:
    """While a drawing takes for ever, moments are dropped and counted, and nobody waits."""
    drawing, go_on = threading.Event(), threading.Event()

    def endless(*args: object) -> None:
        drawing.set()
        go_on.wait(60)

    viewer._drawing.draw = endless  # type: ignore[method-assign]
    viewer.show(moments[-1])
    assert drawing.wait(60)
    for _ in range(2000):
        viewer.show(moments[-1])
    go_on.set()
    deadline = time.monotonic() + 60
    while viewer.drawn < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert viewer.dropped == 1999  # all came while the first was drawn; the newest is next
    assert viewer.drawn == 2


def test_the_estimator_says_the_same_with_a_page(viewer: Viewer) -> None:
    """The page reads what was decided; it changes nothing."""
    alone = demo_moments(load_objects("ycb"))
    shown = demo_moments(load_objects("ycb"), each=viewer.show)
    says = [[h.intention for h in m.hands] for m in alone]
    assert says == [[h.intention for h in m.hands] for m in shown]


def test_a_moment_that_cannot_be_drawn_does_not_end_the_page(
    viewer: Viewer, moments: list[Snapshot]
) -> None:
    draw = viewer._drawing.draw
    tried = threading.Event()

    def fail(*args: object) -> None:
        tried.set()
        raise ZeroDivisionError

    viewer._drawing.draw = fail  # type: ignore[method-assign]
    viewer.show(moments[0])
    assert tried.wait(60)
    viewer._drawing.draw = draw  # type: ignore[method-assign]
    viewer.show(moments[1])
    deadline = time.monotonic() + 60
    while viewer.drawn < 1 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert viewer.drawn == 1


def test_courses_of_a_chosen_hand_stay_between_two_drawings(
    viewer: Viewer, moments: list[Snapshot]
) -> None:
    """Snapshots come faster than the time courses are drawn; none may empty the panels."""
    shown: list[int] = []
    viewer._courses.show = lambda courses, *rest: shown.append(len(courses.times))  # type: ignore[method-assign]
    viewer._options._hand.options = ("all", "right")
    viewer._options._hand.value = "right"
    for count, moment in enumerate(moments[:40], start=1):
        viewer.show(moment)
        deadline = time.monotonic() + 60
        while viewer.drawn + viewer.dropped < count and time.monotonic() < deadline:
            time.sleep(0.001)
    while not shown and time.monotonic() < deadline:
        time.sleep(0.01)
    assert shown
    assert min(shown) > 0


def test_history_is_bounded(viewer: Viewer, moments: list[Snapshot]) -> None:
    from dataclasses import replace

    for k in range(5000):
        viewer.show(replace(moments[-1], t=100.0 + k * 0.005))
    assert len(viewer._history) <= 1000
    viewer.show(replace(moments[-1], t=1.0))  # time began anew
    assert len(viewer._history) == 1


@pytest.mark.browser
@needs_chromium
def test_what_is_on_the_page(viewer: Viewer, moments: list[Snapshot], tmp_path: Path) -> None:
    viewer.note("Task", "left hand to soup")
    for moment in moments:
        viewer.show(moment)
    reaching = next(h for h in moments[-1].hands if h.intention.status == "reaching")
    with open_page(viewer.url) as page:
        page.get_by_text(re.compile(f"reaches for {reaching.intention.target}")).wait_for()
        page.locator(".uplot canvas").first.wait_for()
        text = page.inner_text("body")
        assert "left hand to soup" in text
        assert f"{reaching.intention.grip} grip" in text
        panels = ("speed [m/s]", "impacts", "distance derivative", "distance", "future distance",
                  "global", "target", "grip")  # fmt: skip
        for panel in panels:  # the paper's Figure 6
            assert page.get_by_text(panel, exact=True).count() >= 1, panel
        for id in [placed.id for placed in moments[-1].objects]:
            assert f"■ {id}" in text  # the key of the lines
        charts = page.locator(".uplot canvas").count()
        assert charts == len(panels)
        inked = page.evaluate(INK)
        assert min(inked) > 100, inked  # every panel has lines or marks in colour
        green = 0
        deadline = time.monotonic() + 60
        while green < 300 and time.monotonic() < deadline:  # software rendering is slow to begin
            page.wait_for_timeout(500)
            page.screenshot(path=tmp_path / "page.png")
            green = target_pixels(tmp_path / "page.png")
        assert green >= 300, "the target is not drawn in its colour"


INK = """() => [...document.querySelectorAll('.uplot canvas')].map(canvas => {
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data
  let n = 0
  for (let k = 0; k < pixels.length; k += 4) n += pixels[k + 3] > 128
  return n
})"""


def test_what_comes_and_goes_is_forgotten(viewer: Viewer, moments: list[Snapshot]) -> None:
    """A tracker that numbers its things anew must not fill the page."""
    from dataclasses import replace

    body, hand = moments[-1].objects[0], moments[-1].hands[0]
    for k in range(120):
        said = msgspec.structs.replace(hand.intention, hand=f"hand{k}")
        hands = [replace(hand, intention=said)]
        moment = Snapshot(0.5 * k, [body._replace(id=f"thing{k}")], hands, moments[-1].scene)
        viewer._drawing.draw(moment)
    assert len(viewer._drawing._handles) <= 9 * 22  # of the last ten seconds
    assert len(viewer._drawing.colours) <= 22
    viewer._drawing.draw(replace(moment, t=0.0, objects=[], hands=[]))  # time began anew
    assert not viewer._drawing._handles


@pytest.mark.browser
@needs_chromium
def test_names_from_outside_are_shown_and_not_obeyed(moments: list[Snapshot]) -> None:
    from dataclasses import replace

    bad = "x<iframe srcdoc=\"<script>parent.document.title='taken'</script>\"></iframe>*y*"
    hand = next(h for h in moments[-1].hands if h.intention.status == "reaching")
    said = msgspec.structs.replace(hand.intention, hand=f"<b>{bad}", target=bad)
    viewer = Viewer(port=8471)
    try:
        viewer.note("Task", bad)
        viewer.show(replace(moments[-1], hands=[replace(hand, intention=said)]))
        with open_page(viewer.url) as page:
            page.get_by_text("reaches for").wait_for()
            page.wait_for_timeout(1000)
            assert page.title() != "taken"
            text = page.inner_text("body")
            assert text.count(bad) >= 2
            assert page.locator("iframe").count() == 0
    finally:
        viewer.close()


@pytest.mark.browser
@needs_chromium
def test_choices_on_the_page(moments: list[Snapshot]) -> None:
    chosen: list[str] = []
    viewer = Viewer(port=8471, targets="repaired", choose_targets=chosen.append)
    try:
        for moment in moments:
            viewer.show(moment)
        with open_page(viewer.url) as page:
            page.locator(".uplot canvas").first.wait_for()
            page.get_by_label("targets", exact=True).first.click()
            page.get_by_role("option", name="paper", exact=True).click()
            page.get_by_label("hand", exact=True).first.click()
            page.get_by_role("option", name="right", exact=True).click()
            page.get_by_text("panels").click()
            before = settled(page)
            page.get_by_label("impacts", exact=True).first.uncheck()
            deadline = time.monotonic() + 60
            plots = page.locator(".uplot:visible")
            while plots.count() != before - 1 and time.monotonic() < deadline:
                page.wait_for_timeout(100)
            assert plots.count() == before - 1
        assert chosen == ["paper"]
        assert viewer._options.hand == "right"
    finally:
        viewer.close()


def settled(page) -> int:
    """Return how many plots are visible once that has not changed for a second."""
    counts: list[int] = []
    for _ in range(200):
        counts.append(page.locator(".uplot:visible").count())
        if len(counts) >= 10 and len(set(counts[-10:])) == 1 and counts[-1]:
            break
        page.wait_for_timeout(100)
    return counts[-1]


def target_pixels(path: Path) -> int:
    """Count pixels of the hue of the target's colour."""
    from PIL import Image

    pixels = np.asarray(Image.open(path).convert("RGB")).astype(int)
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    return int(((green > 1.8 * red) & (green > 1.5 * blue) & (green > 60)).sum())
