"""``igrip record`` and ``igrip calibrate`` as a user types them."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from board_pictures import looking_at, see
from igrip.cameras.base import open_camera
from igrip.cameras.board import Board
from igrip.cli import main
from igrip.recording.mcap import McapReader, McapWriter
from rgbd_frames import frame

COMMAND = [sys.executable, "-c", "from igrip.cli import main; main()"]
ENVIRONMENT = {**os.environ, "COLUMNS": "160", "NO_COLOR": "1"}


def igrip(*arguments, code=0):
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=120,
        env=ENVIRONMENT,
    )  # fmt: skip
    assert done.returncode == code, done.stderr + done.stdout
    return done


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "given.mcap"
    with McapWriter(path, lossless=True) as writer:
        for k in range(15):
            writer.write_frame(frame(k))
    return path


@pytest.mark.parametrize("command", ["record", "calibrate"])
def test_help_has_an_example(command, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["igrip", command, "--help"])
    with pytest.raises(SystemExit):
        main()
    assert f"Example: igrip {command}" in capsys.readouterr().out


def test_record_for_some_seconds(tmp_path, recording):
    out = tmp_path / "new.mcap"
    done = igrip("record", "--camera", f"replay:{recording}?loop=1", "--out", out, "--seconds", 1.5)
    assert f"{out}: " in done.stdout
    assert "0 dropped" in done.stdout
    reader = McapReader(out)
    times = [one.t for one in reader.frames()]
    assert reader.cut is None
    assert 45 <= len(times) <= 46
    assert f"{len(times)} frames, 1.5 s, 30.0 Hz" in done.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send")
def test_ctrl_c_ends_cleanly(tmp_path, recording):
    out = tmp_path / "new.mcap"
    arguments = ["record", "--camera", f"replay:{recording}?loop=1", "--out", str(out)]
    with subprocess.Popen(
        [*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=ENVIRONMENT,
    ) as child:  # fmt: skip
        while not out.exists() or out.stat().st_size < 30_000:
            assert child.poll() is None
            time.sleep(0.05)
        child.send_signal(signal.SIGINT)
        said, complaints = child.communicate(timeout=60)
    assert child.returncode == 0, complaints
    reader = McapReader(out)
    count = len(list(reader.frames()))
    assert reader.cut is None
    assert f"{out}: {count} frames" in said


def test_a_camera_that_fails_leaves_a_readable_file(tmp_path):
    """It is a recording that is damaged in the middle."""
    path = tmp_path / "broken.mcap"
    with McapWriter(path) as writer:
        for k in range(4):
            writer.write_frame(frame(k))
        writer._put("/camera/colour", 20.0, b"nonsense")
    out = tmp_path / "new.mcap"
    done = igrip("record", "--camera", f"replay:{path}?speed=0", "--out", out, code=1)
    assert "message 5 of /camera/colour" in done.stderr
    reader = McapReader(out)
    assert len(list(reader.frames())) == 4
    [event] = reader.records(("/events",))
    assert json.loads(event.data)["name"] == "camera failed"
    assert reader.cut is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["record", "--camera", "kinect", "--out", "x.mcap"], "no camera is named 'kinect'"),
        (["record", "--camera", "replay:no.mcap", "--out", "x.mcap"], "no.mcap: no such file"),
        (["record", "--camera", "oak", "--out", "x.jsonl"], "are recorded as .mcap"),
        (["calibrate"], "name the cameras"),
        (["calibrate", "--camera", "oak"], "name the file to write"),
        (["calibrate", "--board", "board.pdf"], "is written as .svg"),
    ],
)
def test_wrong_input(arguments, words, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["igrip", *arguments])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert words in capsys.readouterr().err.replace("\n", "")


def test_calibrate_two_cameras_then_record_with_their_places(tmp_path):
    """Both are in one recording; their places come back through the file and the next recording."""
    board = Board()
    places = {
        "left": looking_at(np.array([-0.35, -0.45, 0.55])),
        "right": looking_at(np.array([0.4, -0.3, 0.7])),
    }
    given, found, new = (tmp_path / name for name in ("board.mcap", "cameras.json", "new.mcap"))
    with McapWriter(given) as writer:
        for k in range(2):
            for name, pose in places.items():
                writer.write_frame(see(board, pose, 1 + k / 30, name, seed=k))
    done = igrip("calibrate", "--camera", f"replay:{given}?speed=0", "--out", found,
                 "--board", tmp_path / "board.svg")  # fmt: skip
    assert "left: at (-0.35" in done.stdout
    assert (tmp_path / "board.svg").read_text().startswith("<svg")
    igrip("record", "--camera", f"replay:{given}?speed=2", "--out", new, "--calibration", found)
    seen = list(open_camera(f"replay:{new}?speed=0"))
    assert {one.camera for one in seen} == set(places)
    for one in seen:
        assert np.abs(one.world_from_camera - places[one.camera]).max() < 0.002
