"""Both screens in a real browser: a whole study by keyboard, killed in between."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pandas as pd
import pytest

from browser import accessibility_problems, needs_chromium, open_page
from igrip.io.datasets.trial import read_trials
from running_study import Running
from runtime_fakes import PATIENCE, until
from small_study import small_study

pytestmark = needs_chromium


def by_keyboard(running, until_done, watch):
    """Do trials by the keyboard alone."""
    with open_page(running.url, 1920, 1080) as page:
        participant = page.context.browser.new_page(viewport={"width": 1920, "height": 1080})
        participant.goto(f"{running.url}/participant")
        while (status := running.status())["done"] < until_done:
            if status["break_due"]:
                page.wait_for_selector("#end_break:not([disabled])")
                page.keyboard.press("e")
                until(lambda: not running.status()["break_due"])
                continue
            number = status["trial"]["number"]
            page.wait_for_selector("#start:not([disabled])")
            participant.wait_for_selector("body.ready")
            until(lambda: status["participant_sees"]["trial"] is None or (
                participant.locator("#lines li").first.text_content()
                == running.status()["participant_sees"]["trial"]["object"]))  # fmt: skip
            page.keyboard.press("Space")
            participant.wait_for_selector("body.go")
            watch(number, page, participant)
            page.keyboard.press("Space")
            until(lambda done=status["done"]: running.status()["done"] == done + 1)
        return page.title()


def test_a_study_by_keyboard_killed_in_mid_trial_and_resumed(tmp_path):
    folder = small_study(tmp_path / "study")
    running = Running(folder)
    seen = []

    def watch(number, page, participant):
        seen.append(number)
        assert participant.locator("#picture").evaluate("i => i.complete && i.naturalWidth > 0")
        until(lambda: "Recording" in page.locator("#phase").text_content())

    by_keyboard(running, 3, watch)
    running.order("start")
    until(lambda: running.status()["recording"])
    assert running.end(signal.SIGKILL) == -signal.SIGKILL
    running = Running(folder)
    assert "interrupted" in " ".join(running.status()["remarks"])
    by_keyboard(running, 8, watch)
    assert running.end(signal.SIGINT) == 130
    assert seen == list(range(1, 9))
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    assert [(r.trial, r.camera) for r in rows if r.performed == "yes"] == [
        (str(n), camera) for n in range(1, 9) for camera in ("left", "right")
    ]
    report = tmp_path / "report"
    subprocess.run(
        [sys.executable, "-m", "igrip", "evaluate", str(folder.path), "--out", str(report),
         "--targets", "bayes"], check=True, capture_output=True,
    )  # fmt: skip
    assert len(pd.read_parquet(report / "trials.parquet")) == 16


CUT = """() => [...document.querySelectorAll('h1, li, p')].filter(e => e.offsetParent && (
    e.scrollWidth > e.clientWidth + 1 || e.getBoundingClientRect().bottom > innerHeight + 1
    || e.getBoundingClientRect().right > innerWidth + 1)).map(e => e.textContent)"""
SIZE = "parseFloat(getComputedStyle(document.querySelector('li')).fontSize)"


@pytest.mark.parametrize("language", ["en", "fr"])
def test_no_text_is_cut_and_all_is_large(tmp_path, language):
    running = Running(small_study(tmp_path / "study", language=f'"{language}"'))
    try:
        with open_page(f"{running.url}/participant") as page:
            page.wait_for_selector("#lines li")
            for phase in ("ready", "go"):
                if phase == "go":
                    running.order("start")
                page.wait_for_selector(f"body.{phase}")
                for width, height in ((1920, 1080), (820, 1180), (1180, 820)):
                    page.set_viewport_size({"width": width, "height": height})
                    assert page.evaluate(CUT) == []
                    assert page.evaluate(SIZE) >= 0.06 * min(width, height)
    finally:
        running.end(signal.SIGINT)


def test_another_computer_needs_the_token(tmp_path):
    token = "a-token-of-sixteen-or-more"
    running = Running(small_study(tmp_path / "study"), "--host", "0.0.0.0", "--token", token)
    assert "0.0.0.0" not in running.url  # no other computer could open it
    url = re.sub(r"//[^:]+", "//127.0.0.1", running.url)
    try:
        for path in ("/", "/status", "/participant"):
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(f"{url}{path}", timeout=PATIENCE)
            urllib.request.urlopen(f"{url}{path}?token={token}", timeout=PATIENCE).close()
    finally:
        running.end(signal.SIGINT)


def test_axe_finds_nothing_on_both_screens(tmp_path):
    running = Running(small_study(tmp_path / "study"))
    try:
        with open_page(running.url, 1920, 1080) as page:
            page.wait_for_selector("#start:not([disabled])")
            for path, ready in (("/", "#start:not([disabled])"), ("/participant", "#lines li")):
                page.goto(f"{running.url}{path}")
                page.wait_for_selector(ready)
                assert accessibility_problems(page) == []
    finally:
        running.end(signal.SIGINT)


def test_the_session_ends_by_a_key_with_a_summary(tmp_path):
    folder = small_study(tmp_path / "study", language='"fr"')
    running = Running(folder)
    with open_page(running.url) as page:
        participant = page.context.browser.new_page()
        participant.goto(f"{running.url}/participant")
        participant.wait_for_selector("body.ready")
        page.wait_for_selector("#start:not([disabled])")
        page.keyboard.press("Space")
        until(lambda: running.status()["recording"])
        page.wait_for_selector("#finish[disabled]")  # not in the middle of a trial
        page.keyboard.press("Space")
        page.wait_for_selector("#finish:not([disabled])")
        page.keyboard.press("f")
        participant.wait_for_selector("body.wait")
        assert participant.inner_text("main").strip() == "Veuillez patienter."
        until(lambda: "same command" in page.inner_text("#problem"))
        assert running.process.wait(PATIENCE) == 0
    printed = running.process.stdout.read()
    running.process.stdout.close()
    running.process.stderr.close()
    assert "P01: 1 of 8 trials" in printed
    assert "1 of 8 trials are done" in (folder.path / "sessions/P01/summary.html").read_text()
