"""Photograph every screen of a study: part of ``make pictures`` (after ``make system``)."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

FOLDER = Path(__file__).parent / "pictures" / "study"
SIZES = ((1920, 1080), (820, 1180))  # a monitor and a tablet
FLAGS = ["--no-sandbox", "--disable-background-networking", "--disable-sync"]
WAIT = 2000  # ms until pictures of cameras are there
PERSON = ("--participant", "P01")


@contextmanager
def serving(*arguments: str) -> Iterator[str]:
    """Run a command of igrip until the block ends; yield the address of its page."""
    command = [sys.executable, "-m", "igrip", "experiment", *arguments, "--port", "0"]
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    ) as (process):
        assert process.stderr is not None
        found = (re.search(r"http://[\w.]+:\d+", line) for line in process.stderr)
        try:
            yield next(one for one in found if one)[0]
        finally:
            process.terminate()


def photograph(page: Page, url: str, ready: str, name: str, wait: int = 500) -> None:
    """Take a screenshot in each size once an element is there, after some milliseconds."""
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        page.goto(url)
        page.wait_for_selector(ready)
        page.wait_for_timeout(wait)
        page.screenshot(path=FOLDER / f"{name}-{width}.png")


def order(url: str, name: str) -> None:
    """Give an order of the experimenter's page."""
    urllib.request.urlopen(f"{url}/{name}", data=b"{}").close()


def main() -> None:
    """Write all pictures."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    igrip = [sys.executable, "-m", "igrip", "experiment"]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        study = Path(folder) / "study"
        subprocess.run([*igrip, "new", str(study), "--template", "small"], check=True)
        file = study / "study.toml"
        browser = play.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page()
        session = ("run", str(study), *PERSON, "--consent", "2026-01-31", "--simulate")
        with serving(*session) as url:
            photograph(page, f"{url}/participant", "body.ready", "participant-ready")
            photograph(page, url, "#start:not([disabled])", "experimenter")
            order(url, "start")
            photograph(page, f"{url}/participant", "body.go", "participant-go")
            for name in ("stop", *3 * ("start", "stop")):  # the fourth trial ends in a break
                order(url, name)
            photograph(page, f"{url}/participant", "body.rest", "participant-rest")
        cameras = [f"--camera={name}=rendered" for name in ("left", "right")]
        rendered = ("run", str(study), "--participant", "P02", "--consent", "2026-01-31")
        with serving(*rendered, *cameras, "--hands", "depth") as url:
            photograph(page, url, "#figures img", "experimenter-cameras", wait=WAIT)
        text = file.read_text(encoding="utf-8")
        file.write_text(text.replace('language = "en"', 'language = "fr"'), encoding="utf-8")
        with serving(*session) as url:
            order(url, "end_break")
            photograph(page, f"{url}/participant", "body.ready", "participant-french")
        subprocess.run([*igrip, *session, "--unattended"], check=True)
        with serving(*session) as url:
            photograph(page, f"{url}/participant", "body.finished", "participant-finished")
        with serving("review", str(study), *PERSON) as url:
            photograph(page, url, "tr[aria-selected=true]", "review")
        summary = study / "sessions" / "P01" / "summary.html"
        photograph(page, summary.as_uri(), "polyline", "summary")
        browser.close()


if __name__ == "__main__":
    main()
