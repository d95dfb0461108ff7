"""``igrip live`` from the terminal, before a camera that is not there."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys

import pytest

import igrip


def live(*options):
    return subprocess.run(
        [sys.executable, "-m", "igrip", "live", *options], capture_output=True, text=True,
        timeout=240, check=False,
    )  # fmt: skip


def test_help_has_an_example():
    told = live("--help").stdout
    assert "Example: igrip live --camera oak" in told
    assert "--calibration" in told


def test_a_camera_that_is_unknown_or_absent_is_said_to_be():
    for camera, words in (("oka", "oak"), ("replay:nowhere.mcap", "nowhere.mcap")):
        done = live("--camera", camera, "--hands", "none", "--headless")
        assert done.returncode == 2
        assert words in done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("camera", "words"),
    [("rendered:1+rendered:2", "--calibration"), ("replay:x.mcap?speed=2", "speed=2")],
)
def test_what_would_mix_places_or_times_is_refused(camera, words):
    done = live("--camera", camera, "--hands", "none", "--objects", "none", "--headless")
    assert done.returncode == 2
    assert words in done.stderr


def test_objects_of_a_rendered_camera_are_seen_recorded_and_replayed(tmp_path):
    out = tmp_path / "live.jsonl"
    done = live(
        "--camera", "rendered:3", "--hands", "none", "--headless", "--seconds", "4", "--json",
        "--out", str(out),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    stage = report["stages"]["rendered: objects"]
    assert stage["count"] >= 3
    assert stage["failed"] == 0
    messages = list(igrip.open_source(out))
    seen = {id for m in messages for id, pose in m.objects.items() if pose is not None}
    assert len(seen) == 4
    gaps = [b.t - a.t for a, b in itertools.pairwise(messages)]
    assert max(gaps) < 1.0  # ticks in between
    again = subprocess.run(
        [sys.executable, "-m", "igrip", "replay", str(out)], capture_output=True, text=True,
        timeout=120, check=False,
    )  # fmt: skip
    assert again.returncode == 0, again.stderr
