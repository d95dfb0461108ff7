"""The page of a device in a real browser: it shows the loop's state, stops it, and passes axe."""

from contextlib import closing

from browser import accessibility_problems, needs_chromium, open_page
from igrip.drive.page import DevicePage
from runtime_fakes import until

STATUS = {
    "name": "serial", "armed": False, "hand": "right", "status": "reaching", "target": "mug",
    "grip": "palmar", "lease": 0.1, "stopped": False, "device": "closing", "detail": "0.4",
    "events": [[1.0, "armed"], [2.0, "lease: mug"]],
}  # fmt: skip


class FakeLoop:
    def __init__(self):
        self.orders = []

    def order(self, name):
        self.orders.append(name)

    def status(self):
        return dict(STATUS)


@needs_chromium
def test_the_page_stops_the_loop_and_axe_finds_nothing():
    loop = FakeLoop()
    with (
        closing(DevicePage(loop, 0)) as served,
        open_page(served.url, 820, 1180) as page,
    ):
        page.get_by_text("lease: mug").wait_for()
        assert "dry run: nothing moves" in page.locator("h1").text_content()
        assert accessibility_problems(page) == []
        page.keyboard.press("Space")
        until(lambda: "stop" in loop.orders)
