"""``igrip live`` from the terminal, before a camera that is not there."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time

import pytest

import igrip
from igrip.cli import main
from igrip.cli.live import _poses_and_objects


def live(*options):
    return subprocess.run(
        [sys.executable, "-m", "igrip", "live", *options], capture_output=True, text=True,
        timeout=290, check=False,
    )  # fmt: skip


def recorded(path):
    """Return the ids of the objects that were recorded so far."""
    lines = path.read_text().splitlines()[:-1] if path.exists() else []
    objects = [json.loads(line).get("objects", {}) for line in lines]
    return {id for one in objects for id, pose in one.items() if pose is not None}


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
    done = live("--camera", camera, "--hands", "none", "--poses", "none", "--headless")
    assert done.returncode == 2
    assert words in done.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--targets", "bayse"], "'bayse' (did you mean 'bayes'?)"),
        (["--out", "stdotu"], "'stdotu' (did you mean 'stdout'?)"),
        (["--camera", "rendred"], "'rendred' (did you mean 'rendered'?)"),
        (["--hands", "mediapip"], "'mediapip' (did you mean 'mediapipe'?)"),
        (["--poses", "dept"], "'dept' (did you mean 'depth'?)"),
        (["--record", "live.jsnl"], "'live.jsnl'"),
        (["--out", "session.mcap"], "--record session.mcap"),
        (["--tell", "lsl"], "--tell was renamed to --out"),
        (["--tell=lsl"], "--tell was renamed to --out"),
        (["--apart"], "--apart was renamed to --separate-hands"),
        (["--catalog", "ycb"], "--catalog was renamed to --objects"),
    ],
)
def test_a_wrong_name_is_refused_before_anything_slow(options, words, monkeypatch, capsys):
    monkeypatch.setattr("igrip.cli.live.load_objects", lambda *_: pytest.fail("read meshes"))
    monkeypatch.setattr(
        sys, "argv", ["igrip", "live", "--camera", "rendered", "--headless", *options]
    )
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert words in " ".join(capsys.readouterr().err.split())


def test_a_pose_estimator_in_objects_still_works_and_names_the_new_option(capsys):
    assert _poses_and_objects("tags", ["depth"]) == ("depth", [])
    assert "--poses depth" in capsys.readouterr().err
    assert _poses_and_objects("tags", ["ycb"]) == ("tags", ["ycb"])
    assert capsys.readouterr().err == ""


def test_objects_of_a_rendered_camera_are_found_recorded_and_replayed(tmp_path):
    out = tmp_path / "live.jsonl"
    process = subprocess.Popen(
        [sys.executable, "-m", "igrip", "live", "--camera", "rendered:3", "--hands", "none",
         "--headless", "--json", "--record", str(out)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        end = time.monotonic() + 240.0
        while len(recorded(out)) < 4:
            assert process.poll() is None, process.stderr.read()
            assert time.monotonic() < end
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        report = json.loads(process.stdout.read())
    assert process.returncode == 0
    stage = report["stages"]["rendered: objects"]
    assert stage["count"] >= 1
    assert stage["failed"] == 0
    messages = list(igrip.open_source(out))
    updates = report["inputs"]["counts"]["messages"]
    assert updates in (len(messages), len(messages) - 1)  # it was interrupted at any moment
    assert any(not message.objects and not message.hands for message in messages)  # ticks
    again = subprocess.run(
        [sys.executable, "-m", "igrip", "replay", str(out)], capture_output=True, text=True,
        timeout=120, check=False,
    )  # fmt: skip
    assert again.returncode == 2
    assert f"no hand in {len(messages)} messages" in again.stderr
