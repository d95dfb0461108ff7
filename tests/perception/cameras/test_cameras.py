"""Names of cameras: what they open, and what is said when they cannot be opened."""

import builtins
import json

import numpy as np
import pytest

from igrip.errors import MissingExtraError, UnknownNameError
from igrip.perception.cameras import CAMERAS, CameraError, open_camera, split_names


def test_a_misspelt_kind_of_camera_is_refused_before_any_is_opened():
    for name in ("oka", "oka:1", "oka?fps=3", "oka:1+webcam:0"):
        with pytest.raises(UnknownNameError, match="did you mean 'oak'"):
            split_names(name)


def test_members():
    assert {"oak", "realsense", "webcam", "replay"} <= set(CAMERAS.names())


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("oak", ["oak"]),
        ("oak:1+oak:2", ["oak:1", "oak:2"]),
        ("oak+webcam:1?fov=60+replay:a+b.mcap", ["oak", "webcam:1?fov=60", "replay:a+b.mcap"]),
        ("replay:a+oaks.mcap", ["replay:a+oaks.mcap"]),
    ],
)
def test_several_names(name, parts):
    assert split_names(name) == parts


def test_an_unknown_camera():
    with pytest.raises(UnknownNameError, match="no camera is named 'kinect'"):
        open_camera("kinect")


@pytest.mark.parametrize(
    ("name", "package", "advice"),
    [
        ("oak", "depthai", r"\(extra oak\): pip install 'depthai"),
        ("realsense", "pyrealsense2", r"\(extra realsense\): pip install 'pyrealsense2"),
        ("webcam", "cv2", r"\(extra hands\): pip install .*'opencv-python-headless"),
    ],
)
def test_a_missing_package(monkeypatch, name, package, advice):
    real = builtins.__import__

    def absent(wanted, *rest):
        if wanted.partition(".")[0] == package:
            raise ImportError(wanted)
        return real(wanted, *rest)

    CAMERAS.names()
    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(MissingExtraError, match=advice):
        open_camera(name)


def test_what_was_opened_is_closed_if_the_next_is_missing(monkeypatch):
    closed = []

    class Good:
        def __iter__(self):
            return iter(())

        def close(self):
            closed.append(self)

    def bad(rest):
        raise CameraError(f"nothing at {rest}")

    CAMERAS.names()
    monkeypatch.setitem(CAMERAS._members, "good", lambda rest: Good())
    monkeypatch.setitem(CAMERAS._members, "bad", bad)
    with pytest.raises(CameraError, match="nothing at here"):
        open_camera("good+bad:here")
    assert len(closed) == 1


def test_a_calibration_is_read_before_anything_is_opened(tmp_path, monkeypatch):
    CAMERAS.names()
    monkeypatch.setitem(CAMERAS._members, "good", lambda rest: pytest.fail("was opened"))
    place = np.eye(4)
    place[0, 0] = 2.0
    told = {
        "cameras": {"a": {"world_from_camera": place.tolist()}},
        "format": "igrip-calibration/1",
    }
    (tmp_path / "c.json").write_text(json.dumps(told))
    with pytest.raises(CameraError, match="no rigid transform"):
        open_camera("good", tmp_path / "c.json")
