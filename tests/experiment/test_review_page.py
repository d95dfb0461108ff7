"""The page of a review in a real browser: by keyboard, by mouse, and what it refuses."""

from __future__ import annotations

import json
import urllib.error
import urllib.request
from contextlib import closing

import pytest

from browser import accessibility_problems, needs_chromium, open_page
from igrip.experiment.review import Review
from igrip.experiment.review_page import ReviewPage
from igrip.experiment.session import Session
from igrip.experiment.simulated import SimulatedRecorder
from igrip.experiment.unattended import run_unattended
from igrip.io.datasets.trial import read_trials
from igrip.io.mcap.frame_recorder import FrameRecorder
from igrip.objects.catalog import load_objects
from live_fakes import frame
from runtime_fakes import PATIENCE, until
from small_study import small_study


class FilmedRecorder(SimulatedRecorder):
    """A simulated recorder whose files also hold pictures."""

    def stop(self):
        for camera, writer in self._writers.items():
            frames = FrameRecorder(writer)
            for message in self._messages[camera][::10]:
                frames.add(frame(message.t))
            frames.close()
        super().stop()


@pytest.fixture
def served(tmp_path):
    folder = small_study(tmp_path / "study")
    recorder = FilmedRecorder(folder.study, load_objects(*folder.study.models), "P01")
    session = Session(folder, folder.enrol("P01", "2026-01-31"), recorder)
    for _ in run_unattended(session):
        pass
    session.close()
    with closing(Review(folder, "P01")) as review:
        review.read()
        with closing(ReviewPage(review, 0)) as page:
            yield folder, page.url


def row_of(folder, name):
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    return next(row for row in rows if row.recording == name)


def selected(page):
    return page.locator("tr[aria-selected=true] td").first.text_content()


@needs_chromium
def test_by_keyboard_and_mouse(served):
    folder, url = served
    with open_page(url, 1920, 1080) as page:
        page.wait_for_selector("tr[aria-selected=true]")
        assert page.locator("#rows tr").count() == 16
        page.wait_for_function("document.getElementById('film').naturalWidth > 0")
        before = page.evaluate("[...current.automatic]")
        page.keyboard.press("ArrowRight")  # onset, one sample later
        page.keyboard.press("e")
        page.keyboard.press("Shift+ArrowLeft")  # end, ten samples earlier
        until(lambda: row_of(folder, "P01_t001_left").onset_s is not None)
        page.wait_for_selector("#automatic:not([disabled])")
        step = page.evaluate("current.speeds[1][0] - current.speeds[0][0]")
        row = row_of(folder, "P01_t001_left")
        assert (row.onset_s, row.end_s) == pytest.approx(
            (before[0] + step, before[1] - 10 * step), abs=1e-4
        )
        page.keyboard.press("w")
        until(lambda: row_of(folder, "P01_t001_right").performed == "no")
        page.keyboard.press("a")
        until(lambda: row_of(folder, "P01_t001_left").onset_s is None)
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowDown")
        until(lambda: selected(page) == "2")
        page.wait_for_function("current.recording === 'P01_t002_left'")
        box = page.locator("#speed").bounding_box()
        at = page.evaluate("x_of(bounds[1])") / 480 * box["width"] + box["x"]
        middle = box["y"] + box["height"] / 2
        page.mouse.move(at, middle)
        page.mouse.down()
        page.mouse.move(at + 30, middle, steps=4)
        page.mouse.up()
        until(lambda: row_of(folder, "P01_t002_left").end_s is not None)
        moved = page.evaluate("t_of(x_of(current.automatic[1]) + 30 / arguments_width)".replace(
            "arguments_width", str(box["width"] / 480)))  # fmt: skip
        assert row_of(folder, "P01_t002_left").end_s == pytest.approx(moved, abs=0.02)


@needs_chromium
@pytest.mark.parametrize("size", [(1920, 1080), (820, 1180)])
def test_axe_finds_nothing(served, size):
    with open_page(served[1], *size) as page:
        page.wait_for_selector("tr[aria-selected=true]")
        page.wait_for_function("current !== null")
        assert accessibility_problems(page) == []


def test_what_it_refuses_it_names(served):
    folder, url = served

    def post(path, **values):
        request = urllib.request.Request(f"{url}{path}", data=json.dumps(values).encode())
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=PATIENCE)
        with closing(refused.value) as answer:
            return answer.code, answer.read().decode()

    name = "P01_t001_left"
    assert "must lie within" in post("/correct", recording=name, onset_s=2, end_s=1)[1]
    assert "must be numbers" in post("/correct", recording=name, onset_s="x", end_s=1)[1]
    assert "is no recording" in post("/judge", recording="../x", performed=True)[1]
    assert post("/judge", recording=name, performed="yes")[0] == 404
    for path in ("/picture/../../etc/0", f"/picture/{name}/9999", "/recording/nothing"):
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(f"{url}{path}", timeout=PATIENCE)
    assert row_of(folder, name).onset_s is None
