"""The model: put together once, checked, and an error that helps where it cannot be had."""

from __future__ import annotations

import hashlib
import subprocess
import zipfile

import pytest

from igrip.errors import IgripError
from igrip.perception.hands import _mediapipe_model as model

CONTENT = {"palm.tflite": b"palm" * 100, "hand.tflite": b"hand" * 100}


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """A wheel of two small networks, and a cache of its own."""
    networks = {
        f"{name}.task": (name, hashlib.sha256(data).hexdigest()) for name, data in CONTENT.items()
    }
    monkeypatch.setattr(model, "NETWORKS", networks)
    monkeypatch.setattr(model, "cache_directory", lambda: tmp_path / "cache")
    path = tmp_path / "donor.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in CONTENT.items():
            archive.writestr(name, data)
    return path


def test_it_is_zipped_uncompressed_and_then_there(wheel):
    path = model.hand_model(wheel)
    with zipfile.ZipFile(path) as task:
        assert {info.filename: info.compress_type for info in task.infolist()} == {
            "palm.tflite.task": zipfile.ZIP_STORED,
            "hand.tflite.task": zipfile.ZIP_STORED,
        }
        assert task.read("palm.tflite.task") == CONTENT["palm.tflite"]
    wheel.unlink()
    assert model.hand_model() == path  # nothing is asked for any more


def test_a_damaged_model_is_made_anew(wheel):
    path = model.hand_model(wheel)
    path.write_bytes(path.read_bytes()[:300])
    with zipfile.ZipFile(model.hand_model(wheel)) as task:
        assert task.testzip() is None


def test_another_network_is_refused(wheel):
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("palm.tflite", b"something else")
        archive.writestr("hand.tflite", CONTENT["hand.tflite"])
    with pytest.raises(IgripError, match=r"palm\.tflite .*SHA-256"):
        model.hand_model(wheel)


@pytest.mark.parametrize("content", [b"", b"no zip"])
def test_what_is_no_wheel_is_refused(wheel, content):
    wheel.write_bytes(content)
    with pytest.raises(IgripError, match="no wheel of mediapipe"):
        model.hand_model(wheel)


def test_without_cache_and_network_it_says_what_to_do(wheel, monkeypatch):
    def offline(command, **_):
        assert command[2:4] == ["pip", "download"]
        return subprocess.CompletedProcess(command, 1, "", "tried\nERROR: No matching distribution")

    monkeypatch.setattr(model.subprocess, "run", offline)
    with pytest.raises(IgripError, match=r"No matching distribution.*connect once, or copy"):
        model.hand_model()


def test_a_network_that_hangs_is_given_up(wheel, monkeypatch):
    def hang(command, timeout, **_):
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(model.subprocess, "run", hang)
    with pytest.raises(IgripError, match="could not fetch"):
        model.hand_model()
