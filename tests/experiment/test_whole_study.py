"""Whole studies: the paper's 128 trials × 2 cameras, and both screens, killed again and again."""

import json
import random
import signal
import subprocess
import sys
import time

import pytest

from browser import needs_chromium, open_page
from igrip.cli.outputs import free_port
from igrip.experiment.folder import StudyFolder, new_study
from igrip.experiment.session import TRANSITIONS
from igrip.io.datasets.trial import read_trials
from running_study import Running
from runtime_fakes import until
from small_study import small_study

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


def test_the_papers_study_is_whole_after_kills(tmp_path):
    path = tmp_path / "study"
    new_study(path, "paper")
    command = [
        sys.executable, "-m", "igrip", "experiment", "run", str(path), "--participant", "P01",
        "--consent", "2026-01-31", "--simulate", "--unattended",
    ]  # fmt: skip
    random.seed(1)
    for _ in range(8):
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        time.sleep(random.uniform(4.0, 9.0))
        process.kill()
        process.communicate()
    subprocess.run(command, check=True, capture_output=True, timeout=1200)
    folder = StudyFolder(path)
    progress = folder.progress("P01")
    counted = [one.trial for one in progress.attempts if one.counts]
    assert counted == list(range(1, 129))  # every trial exactly once, in the plan's order
    rows = read_trials(path / "trials.tsv", lenient=False)
    assert [(row.trial, row.camera) for row in rows] == [
        (str(n), camera) for n in counted for camera in ("left", "right")
    ]
    files = {file.stem for file in (path / "recordings").iterdir()}
    assert files == {row.recording for row in rows}
    check = [sys.executable, "-m", "igrip", "check", str(path), "--json"]
    found = json.loads(subprocess.run(check, capture_output=True, check=False).stdout)
    assert (found["trials"], found["unused_recordings"]) == (256, [])
    # a camera of the simulation may miss a hidden object all the time; nothing else is wrong
    wrong = [flaw for flaw in found["flaws"] if flaw["verdict"] == "error"]
    assert all("never appears" in str(flaw) for flaw in wrong)
    assert len(wrong) < 13
    assert (path / "sessions/P01/summary.html").exists()


@needs_chromium
def test_both_screens_stay_open_through_a_kill_at_every_transition(tmp_path):
    folder = small_study(tmp_path / "study")
    port = str(free_port(0))
    with open_page("about:blank", 1920, 1080) as page:
        participant = page.context.browser.new_page()
        for transition in TRANSITIONS:
            running = Running(folder, "--port", port, killed_at=transition)
            if page.url == "about:blank":
                page.goto(running.url)
                participant.goto(f"{running.url}/participant")
            press_until(page, lambda one=running: one.process.poll() is not None,
                        "r" if transition == "marked" else "Space")  # fmt: skip
            assert running.end(signal.SIGKILL) == -signal.SIGKILL
            until(lambda: "ended" in page.inner_text("#phase"))
            participant.wait_for_selector("body.wait")
        running = Running(folder, "--port", port)
        press_until(page, lambda: running.status()["phase"] == "finished", "Space")
        participant.wait_for_selector("body.finished")
        assert running.end(signal.SIGINT) == 130
    counted = [one.trial for one in folder.progress("P01").attempts if one.counts]
    assert counted == list(range(1, 9))  # every trial exactly once
    rows = read_trials(folder.path / "trials.tsv", lenient=False)
    assert {f"{row.recording}.mcap" for row in rows} == {
        file.name for file in folder.recordings.iterdir()
    }
    report = tmp_path / "report"
    evaluate = [sys.executable, "-m", "igrip", "evaluate", str(folder.path), "--out", str(report)]
    subprocess.run([*evaluate, "--targets", "bayes"], check=True, capture_output=True)
    assert (report / "report.html").exists()


def press_until(page, is_over, key):
    """Do trials by the keyboard alone until something is the case."""
    until(lambda: page.locator("#start:disabled").count() == 0 or is_over())
    while not is_over():
        for name in ("e", "Space", "Space", key):
            page.keyboard.press(name)
            page.wait_for_timeout(400)
