"""The page as a whole: title and icon, widths, keys, axe, trials, looking back."""

from __future__ import annotations

import time
import urllib.request

import pytest

from browser import needs_chromium
from igrip.cli.view import list_trials
from igrip.io.datasets.dataset import Dataset
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.viewer.grip_page import GripPage
from igrip.viewer.playback import LEAD, Player, first_decision
from igrip.viewer.server import Viewer
from scripted_recording import DECIDED, LEASED, OTHER, STEP

pytestmark = [pytest.mark.browser, needs_chromium]
LIVE = 15  # moments of the scripted recording, when a hand decides


def wait_for(page, condition):
    end = time.monotonic() + 60
    while not condition() and time.monotonic() < end:
        page.wait_for_timeout(20)
    assert condition()


def problems(page):
    """Return what axe finds."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page).response["violations"]
    return [(rule["id"], [node["html"][:200] for node in rule["nodes"]]) for rule in found]


@pytest.fixture
def live(chromium, snapshots):
    """A live page that has seen the recording up to the first decision."""
    viewer = Viewer(port=0, targets="bayes", choose_targets=lambda name: None)
    page = chromium.new_page(viewport={"width": 1280, "height": 1000})
    page.goto(viewer.url)
    for snapshot in snapshots[: LIVE + 1]:
        viewer.show(snapshot)
        page.wait_for_function("(t) => igrip.store.scene?.t > t - 1e-4", arg=snapshot.t)
    page.wait_for_function("() => igrip.settled()")
    yield page
    page.close()
    viewer.close()


def test_title_and_icon_are_igrips(shown):
    assert shown.page.title() == "igrip"
    shown.viewer.note("Task", "to soup")
    shown.page.wait_for_function("() => document.title === 'Task – igrip'")
    icon = shown.page.locator("link[rel=icon]").get_attribute("href")
    with urllib.request.urlopen(f"{shown.viewer.url}/{icon}", timeout=20) as answer:
        assert answer.headers["Content-Type"].startswith("image/svg+xml")
        assert b"<svg" in answer.read()


@pytest.mark.parametrize("width", [1920, 820, 390])
def test_it_fits_the_width(shown, width):
    shown.page.set_viewport_size({"width": width, "height": 900})
    shown.page.locator("details").evaluate_all("all => all.forEach((box) => { box.open = true })")
    shown.go(LEASED)
    assert shown.page.evaluate("document.documentElement.scrollWidth") <= width
    for control in shown.page.locator("button:visible, select:visible, input:visible").all():
        box = control.bounding_box()
        if control.evaluate("n => Boolean(n.closest('details > div'))"):
            continue  # a wide table scrolls in a box of its own
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    for button in shown.page.locator("button:visible").all():
        assert button.bounding_box()["height"] >= 24  # WCAG 2.5.8
    shown.page.set_viewport_size({"width": 1280, "height": 1000})
    shown.page.locator("details").evaluate_all(
        "all => all.forEach((box) => { box.open = box.id === 'table' })"
    )


@pytest.mark.parametrize("width", [1280, 390])
def test_axe_finds_nothing(shown, width):
    """Keyboard, contrast, labels and roles, with everything unfolded."""
    shown.page.set_viewport_size({"width": width, "height": 900})
    shown.page.locator("details").evaluate_all("all => all.forEach((box) => { box.open = true })")
    shown.go(OTHER)
    assert problems(shown.page) == []
    shown.page.set_viewport_size({"width": 1280, "height": 1000})


def test_axe_finds_nothing_on_the_page_of_grips(chromium, ycb):
    viewer = GripPage([ycb[name] for name in PAPER_OBJECTS], 0.85, port=0)
    page = chromium.new_page()
    try:
        page.goto(viewer.url)
        page.locator("#borders").get_by_text("021_bleach_cleanser").wait_for()
        assert problems(page) == []
        assert page.title() == "Grip by height – igrip"
    finally:
        page.close()
        viewer.close()


def test_every_control_is_reached_by_tab_and_is_seen_to_be(shown):
    shown.go(LEASED)
    page = shown.page
    page.evaluate("document.activeElement.blur()")
    wanted = page.locator("button:visible, select:visible:enabled, input:visible, #gl").count()
    reached = set()
    for _ in range(wanted + 12):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(
            "(() => { const n = document.activeElement, all = [...document.querySelectorAll('*')];"
            " return [n.matches('button, select, input, #gl') ? all.indexOf(n) : -1,"
            " getComputedStyle(n).outlineStyle] })()"
        )
        if name >= 0:
            reached.add(name)
            assert outline != "none"
    assert len(reached) == wanted


def test_looking_back_in_a_live_scene(live, snapshots):
    frame = live.evaluate("igrip.charts().right.probability.frame")
    part = (5 * STEP - frame["from"]) / (frame["to"] - frame["from"])
    chart = live.locator("#charts .chart canvas").last
    chart.click(position={"x": frame["left"] + part * frame["width"], "y": 60})
    live.wait_for_function("() => igrip.settled()")
    cursor = live.evaluate("igrip.store.cursor")
    assert cursor == pytest.approx(5 * STEP, abs=0.02)
    sentence = live.locator(".card[data-hand=right] .sentence")
    assert sentence.inner_text() == "rests"
    charts = live.evaluate("igrip.charts()")
    for own in charts.values():
        assert own["probability"]["cursor"] == own["decision"]["cursor"] == cursor
    assert float(live.locator("#slider").input_value()) == pytest.approx(cursor, abs=1e-3)
    live.get_by_role("button", name="Back to now").click()
    live.wait_for_function("() => igrip.settled() && igrip.store.cursor === null")
    assert sentence.inner_text().split() == ["reaches", "for", "B", "soup"]


def test_trials_of_a_dataset_are_listed_found_and_opened(shown, small_dataset):
    page, viewer = shown.page, shown.viewer
    dataset = Dataset.open(small_dataset.path)
    opened = []
    viewer.handle("trial", opened.append)
    viewer.publish("trials", list_trials(dataset))
    viewer.publish("trial", {"number": 1})
    page.locator("#trials").wait_for()
    page.locator("#trials").evaluate("n => n.open = true")
    rows = page.locator("#trial-list tbody tr")
    wait_for(page, lambda: rows.count() == len(dataset.trials) == 2)
    for k, trial in enumerate(dataset.trials):
        assert str(trial.target) in rows.nth(k).inner_text()
    assert rows.nth(0).get_by_role("button").get_attribute("aria-current") == "true"
    page.get_by_label("Filter").fill(str(dataset.trials[1].target))
    wait_for(page, lambda: rows.count() == 1)
    rows.get_by_role("button").click()
    page.get_by_role("button", name="Next trial").click()
    wait_for(page, lambda: opened == [2, 2])


def test_view_opens_playing_at_a_moment_with_something_to_see(chromium, snapshots):
    viewer = Viewer(port=0)
    player = Player(viewer, snapshots)
    page = chromium.new_page()
    try:
        assert first_decision(snapshots) == pytest.approx(LIVE * STEP - LEAD)
        assert not player.head.playing  # it waits for somebody to look
        page.goto(viewer.url)
        wait_for(page, lambda: player.head.playing)
        assert snapshots[player.head.index].t == pytest.approx(first_decision(snapshots))
    finally:
        page.close()
        viewer.close()


def test_keys_play_and_step(shown):
    shown.go(DECIDED)
    asked = []
    for name in ("play", "step"):
        shown.viewer.handle(name, lambda value, name=name: asked.append((name, value)))
    shown.page.evaluate("document.activeElement.blur()")
    for key in (" ", ",", "."):
        shown.page.keyboard.press(key)
    wait_for(shown.page, lambda: len(asked) >= 3)
    assert asked == [("play", True), ("step", -1), ("step", 1)]


def test_a_page_whose_igrip_has_ended_says_so(chromium, snapshots):
    viewer = Viewer(port=0)
    page = chromium.new_page()
    try:
        page.goto(viewer.url)
        viewer.show(snapshots[DECIDED])
        page.locator(".card[data-hand=right]").wait_for()
        viewer.close()
        notice = page.get_by_text("igrip has stopped, or is out of reach. What is shown is old.")
        notice.wait_for()
        assert notice.count() == 1
    finally:
        page.close()
        viewer.close()
