"""The paper's study with nobody there: 128 trials × 2 cameras, killed now and then."""

import json
import random
import subprocess
import sys
import time

import pytest

from igrip.experiment.folder import StudyFolder, new_study
from igrip.io.datasets.trial import read_trials

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
