"""``igrip record`` and ``igrip calibrate`` as a user types them."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from board_pictures import looking_at, see
from igrip.cli import main
from igrip.errors import RecordingError
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter
from igrip.io.recordings import open_source, open_writer
from igrip.perception.calibration.board import Board
from igrip.perception.cameras import open_camera
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


def run(monkeypatch, capsys, code, *arguments):
    """Do the same in this process, which is faster."""
    monkeypatch.setattr(sys, "argv", ["igrip", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == code
    return capsys.readouterr()


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "given.mcap"
    with McapWriter(path, lossless=True) as writer:
        for k in range(15):
            writer.write_frame(frame(k))
    return path


@pytest.mark.parametrize("command", ["record", "calibrate"])
def test_help_has_an_example(command, monkeypatch, capsys):
    assert f"Example: igrip {command}" in run(monkeypatch, capsys, 0, command, "--help").out


def test_record_for_some_seconds(tmp_path, recording):
    out = tmp_path / "new.mcap"
    done = igrip("record", "--camera", f"replay:{recording}?loop=1", "--out", out, "--seconds", 1.5)
    assert f"{out}: " in done.stdout
    reader = McapReader(out)
    count = len(list(reader.frames()))
    assert reader.cut is None
    summary = re.search(r"(\d+) frames, 1.5 s, 30.0 Hz, .* MB, (\d+) dropped", done.stdout)
    written, dropped = map(int, summary.groups())
    assert written == count
    assert 45 <= written + dropped <= 46  # a busy machine may drop some


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


def test_a_lens_is_found_and_used(tmp_path, monkeypatch, capsys):
    rng = np.random.default_rng(1)
    given, lens = tmp_path / "board.mcap", tmp_path / "lens.json"
    with McapWriter(given) as writer:
        for k in range(9):
            pose = looking_at(np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(0.3, 0.45)]))
            writer.write_frame(see(Board(), pose, 1 + k / 30, seed=k))
    camera = f"replay:{given}?speed=0"
    said = run(monkeypatch, capsys, 0, "calibrate", "--camera", camera, "--lens", lens).out
    assert "of 1280 × 720; " in said
    assert json.loads(lens.read_text())["fx"] == pytest.approx(900.0, rel=0.01)


def test_a_full_disk(tmp_path, recording, monkeypatch, capsys):
    """As if it were full at the third frame: what is there is said, and why it ended."""
    write = McapWriter.write_frame

    def full(self, one):
        if self.counts.get("/camera/colour", 0) == 3:
            raise RecordingError(f"{self.path}: No space left on device")
        write(self, one)

    monkeypatch.setattr(McapWriter, "write_frame", full)
    out = tmp_path / "new.mcap"
    said = run(monkeypatch, capsys, 2, "record", "--camera", f"replay:{recording}", "--out", out)
    assert "3 frames" in said.out
    assert "No space left on device" in said.err
    assert len(list(McapReader(out).frames())) == 3


def test_replaying_mcap_and_jsonl_gives_the_same_lines(
    tmp_path, small_dataset, monkeypatch, capsys
):
    path = small_dataset.recording(small_dataset.trials[0])
    with open_writer(tmp_path / "reach.mcap") as file:
        for observation in open_source(path):
            file.write(observation)
    for source, out in ((path, "a.jsonl"), (tmp_path / "reach.mcap", "b.mcap")):
        run(monkeypatch, capsys, 0, "replay", source, "--targets", "paper", "--out", tmp_path / out,
            "--objects", *small_dataset.objects)  # fmt: skip
    lines = [r.data for r in McapReader(tmp_path / "b.mcap").records(("/intentions",))]
    assert lines == (tmp_path / "a.jsonl").read_bytes().splitlines()
    assert len(lines) == 61


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
    assert words in run(monkeypatch, capsys, 2, *arguments).err.replace("\n", "")


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
