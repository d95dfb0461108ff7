"""Webcams: what they give, what is assumed of them, and what is said when they are gone."""

import json

import cv2
import numpy as np
import pytest

from igrip.perception.cameras import CameraError, open_camera


class Capture:
    """As OpenCV's, with some pictures."""

    pictures = 3
    opened = True

    def __init__(self, number):
        self.number, self.left, self.released = number, self.pictures, False
        self.settings = {}

    def isOpened(self):  # noqa: N802
        return self.opened

    def set(self, key, value):
        self.settings[key] = value

    def grab(self):
        self.left -= 1
        return self.left >= 0

    def retrieve(self):
        return True, np.full((480, 640, 3), [1, 2, self.left], np.uint8)

    def release(self):
        self.released = True


@pytest.fixture
def capture(monkeypatch):
    class Own(Capture):
        pass

    monkeypatch.setattr(cv2, "VideoCapture", Own)
    return Own


def test_frames_until_it_is_unplugged(capture):
    camera = open_camera("webcam:2?fov=90")
    iterator = iter(camera)
    seen = [next(iterator) for _ in range(3)]
    assert (seen[0].colour == [2, 2, 1]).all()  # red first
    assert seen[0].depth is None
    assert seen[0].camera == "webcam-2"
    assert seen[0].intrinsics == pytest.approx((640, 480, 320.0, 320.0, 319.5, 239.5))
    assert seen[0].t < seen[1].t < seen[2].t
    assert camera.note is None
    with pytest.raises(CameraError, match="webcam-2 has stopped; is it still plugged in"):
        next(iterator)
    camera.close()


def test_what_is_assumed_is_said(capture):
    assert "assumed to be 65° across" in open_camera("webcam").note


def test_none_there(capture):
    capture.opened = False
    with pytest.raises(CameraError, match="there is no webcam 7"):
        open_camera("webcam:7")


def test_a_lens_from_a_file(tmp_path, capture):
    told = {"width": 1280, "height": 960, "fx": 1000, "fy": 1002, "cx": 639.5, "cy": 479.5}
    (tmp_path / "lens.json").write_text(json.dumps(told))
    frame = next(iter(open_camera(f"webcam:0?intrinsics={tmp_path / 'lens.json'}")))
    assert frame.intrinsics == pytest.approx((640, 480, 500.0, 501.0, 319.5, 239.5))


@pytest.mark.parametrize("name", ["webcam:front", "webcam?fov=200", "webcam?speed=1"])
def test_names_that_are_wrong(name):
    with pytest.raises(CameraError):
        open_camera(name)
