"""``igrip scan`` as a user types it."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import igrip
from igrip.cli import console
from igrip.cli.app import app
from igrip.io.mcap.writer import McapWriter
from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.model import build_model
from igrip.perception.cameras._turned_thing import EYE, standing

CAN = build_model("plain can", trimesh.creation.cylinder(0.034, 0.1, sections=64))
CAMERA = look_at(EYE, np.array([0.0, 0.0, 0.06]))


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console.errors, "_width", 300)
    return tmp_path


def scan(*arguments):
    done = CliRunner().invoke(app, ["scan", *arguments])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.stdout, done.stderr


def record(path, *placed):
    scene = RenderedScene({str(k): one for k, one in enumerate(placed)}, CAMERA)
    random = np.random.default_rng(0)
    with McapWriter(path, lossless=True) as writer:
        for k in range(8):
            writer.write_frame(scene.frame(1.0 + 0.1 * k, random))


def at(x=0.0):
    return PlacedMesh(CAN, standing(CAN, 0.0, np.array([x, 0.0])))


def test_help_has_an_example():
    _, told, _ = scan("--help")
    assert "Example: igrip scan my_mug --camera oak --out meshes" in told


def test_a_round_thing_from_a_recording(here):
    record("can.mcap", at())
    code, out, told = scan("beans", "--camera", "replay:can.mcap?speed=0", "--round")
    assert code == 0, told
    assert "view 1, 360 of 360 degrees seen" in told
    assert out.startswith("meshes/beans.ply: ")
    assert "igrip live --camera 'replay:can.mcap?speed=0' --objects meshes --model beans" in out
    model = igrip.load_objects("meshes")["beans"]
    np.testing.assert_allclose(np.ptp(model.vertices, axis=0), [0.068, 0.068, 0.1], rtol=0.05)
    assert model.symmetry == "cylinder"
    code, _, told = scan("beans", "--camera", "replay:can.mcap?speed=0", "--round")
    assert code == 2
    assert "meshes/beans.ply exists: choose another name, or replace it with --replace" in told


@pytest.mark.parametrize(
    ("things", "words"),
    [([], "nothing stands on the table"), ([-0.1, 0.1], "2 things stand on the table: leave only"),
     ([0.0], "turn it on, by about 30 degrees")],
)  # fmt: skip
def test_a_recording_of_too_little_is_explained_and_nothing_is_written(here, things, words):
    record("some.mcap", *(at(x) for x in things))
    code, out, told = scan("beans", "--camera", "replay:some.mcap?speed=0")
    assert code == 2
    assert out == ""
    assert words in told
    assert not (here / "meshes").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["025_mug"], "is a model of the YCB set"), (["a/b"], "cannot be a name"),
        (["cup", "--camera", "rendred"], "did you mean 'rendered'"),
        (["cup", "--camera", "rendered+rendered:2"], "a scan needs one camera"),
        (["cup", "--hands", "mediapip"], "did you mean 'mediapipe'"),
        (["cup", "--out", "file"], "is a file"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_before_the_camera_is_opened(here, monkeypatch, arguments, words):
    (here / "file").write_text("kept")
    monkeypatch.setattr("igrip.cli.scan.open_camera", lambda *_: pytest.fail("opened a camera"))
    code, _, told = scan(*arguments)
    assert code == 2
    assert words in told
    assert len(told.splitlines()) == 1


def test_ctrl_c_ends_it_in_one_line(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "igrip", "scan", "cup", "--camera", "rendered?turn=025_mug"],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        lines = []
        end = time.monotonic() + 250.0
        while not lines or not lines[-1].startswith("view 1"):
            assert time.monotonic() < end
            lines.append(process.stderr.readline())
        process.send_signal(signal.SIGINT)
        told = process.stderr.read()
        assert process.stdout.read() == ""
    assert process.returncode == 130
    assert told.splitlines()[-1] == "igrip: stopped; nothing was written"
    assert "Traceback" not in told
    assert not (tmp_path / "meshes").exists()
