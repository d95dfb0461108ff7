"""A name is given to an unknown thing on the page, and reaches the file of names."""

from __future__ import annotations

import time

import pytest

from browser import accessibility_problems, needs_chromium
from igrip.errors import IgripError

pytestmark = [pytest.mark.browser, needs_chromium]


def until(page, condition):
    end = time.monotonic() + 60
    while not condition() and time.monotonic() < end:
        page.wait_for_timeout(20)
    assert condition()


@pytest.fixture
def naming(chromium):
    """A page with two unknown things; ``given`` holds the names that reached igrip."""
    from igrip.viewer.naming_panel import NamingPanel
    from igrip.viewer.server import Viewer

    given = []

    def give(id, name):
        if name == "soup":
            raise IgripError("'soup' is taken: choose another name")
        given.append((id, name))

    viewer = Viewer(port=0)
    panel = NamingPanel(viewer, give)
    page = chromium.new_page(viewport={"width": 1280, "height": 1000})
    page.goto(viewer.url)
    yield page, panel, given
    page.close()
    viewer.close()


def test_there_is_nothing_to_name_without_unknown_things(naming):
    page, panel, _ = naming
    panel.set_things([])
    page.wait_for_function("() => igrip.store.setup.version")
    assert not page.locator("#naming").is_visible()


def test_a_name_is_given_with_the_keyboard(naming):
    page, panel, given = naming
    panel.set_things(["object_1", "object_2"])
    field = page.get_by_label("Name for object_2")
    field.wait_for()
    field.focus()
    page.keyboard.type("my mug")
    page.keyboard.press("Enter")
    until(page, lambda: given == [("object_2", "my mug")])
    said = page.locator("#naming-answer")
    until(page, lambda: said.inner_text() == "object_2 is my mug from the next run on.")
    assert page.locator("form[data-thing=object_2] .given").inner_text() == "named my mug"
    assert page.locator("form[data-thing=object_1] .given").inner_text() == ""
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Give name"


def test_what_is_typed_stays_while_other_things_appear(naming):
    page, panel, _ = naming
    panel.set_things(["object_1"])
    field = page.get_by_label("Name for object_1")
    field.fill("my b")
    panel.set_things(["object_1", "object_2"])
    page.get_by_label("Name for object_2").wait_for()
    assert field.input_value() == "my b"


def test_a_refused_name_is_explained(naming):
    page, panel, given = naming
    panel.set_things(["object_1"])
    page.get_by_label("Name for object_1").fill("soup")
    page.get_by_role("button", name="Give object_1 this name").click()
    page.get_by_text("Not named: 'soup' is taken: choose another name").wait_for()
    assert given == []


@pytest.mark.parametrize("width", [1280, 390])
def test_axe_finds_nothing_and_it_fits(naming, width):
    page, panel, _ = naming
    page.set_viewport_size({"width": width, "height": 900})
    panel.set_things(["object_1", "object_2", "a thing with a rather long name of its own"])
    page.get_by_label("Name for object_2").wait_for()
    assert accessibility_problems(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    for button in page.locator("#naming button").all():
        assert button.bounding_box()["height"] >= 24  # WCAG 2.5.8


def test_what_no_page_would_send_is_ignored(naming):
    page, panel, given = naming
    panel.set_things(["object_1"])
    page.get_by_label("Name for object_1").wait_for()
    for message in ('{id: "object_9", name: "x"}', '{id: "object_1", name: 3}', '"x"'):
        page.evaluate(
            "() => new Promise((done) => { const s = new WebSocket(`ws://${location.host}/socket`);"
            f" s.onopen = () => {{ s.send(JSON.stringify({{name: {message}}})); done() }} }})"
        )
    field = page.get_by_label("Name for object_1")
    field.fill("box")
    field.press("Enter")
    until(page, lambda: given)
    assert given == [("object_1", "box")]
