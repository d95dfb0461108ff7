"""Webcams: what they give, what is assumed of them, and what is said when they are gone."""

import json
import math

import cv2
import numpy as np
import pytest

from igrip.perception.calibration.lens import Lens
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


def test_distortion_is_taken_out(tmp_path):
    """A straight line, bent by a known lens, is straight again."""
    k = np.array([[300.0, 0, 159.5], [0, 300.0, 119.5], [0, 0, 1]])
    bent = np.array([-0.3, 0.05, 0, 0, 0])
    told = {"width": 320, "height": 240, "fx": 300, "fy": 300, "cx": 159.5, "cy": 119.5}
    told["distortion"] = bent.tolist()
    (tmp_path / "lens.json").write_text(json.dumps(told))
    points = np.stack([np.linspace(20, 300, 15), np.full(15, 40.0)], axis=1)
    rays = np.column_stack([(points - [159.5, 119.5]) / 300, np.ones(15)])
    seen = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), k, bent)[0].reshape(-1, 2)
    y, x = np.mgrid[:240, :320]
    picture = np.zeros((240, 320, 3), np.uint8)
    for u, v in seen:
        spot = 255 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / 4)
        picture = np.maximum(picture, spot[..., None].astype(np.uint8))
    colour, own = Lens(str(tmp_path / "lens.json")).see(picture)
    assert own.fx == 300
    for u, v in points:
        part = np.s_[int(v) - 5 : int(v) + 6, int(u) - 5 : int(u) + 6]
        light = colour[part][..., 0].astype(float)
        assert (x[part] * light).sum() / light.sum() == pytest.approx(u, abs=0.1)
        assert (y[part] * light).sum() / light.sum() == pytest.approx(v, abs=0.1)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"width": 0}',
             '{"width": 64, "height": 48, "fx": -1, "fy": 1, "cx": 1, "cy": 1}',
             '{"width": 64, "height": 48, "fx": NaN, "fy": 1, "cx": 1, "cy": 1}'],
)  # fmt: skip
def test_files_that_are_none(tmp_path, text):
    (tmp_path / "lens.json").write_text(text)
    with pytest.raises(CameraError, match=r"lens\.json"):
        Lens(str(tmp_path / "lens.json"))


def test_a_picture_of_another_shape(tmp_path):
    told = {"width": 64, "height": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5}
    (tmp_path / "lens.json").write_text(json.dumps(told))
    with pytest.raises(CameraError, match="the picture is 64 × 64"):
        Lens(str(tmp_path / "lens.json")).see(np.zeros((64, 64, 3), np.uint8))


@pytest.mark.parametrize("name", ["webcam:front", "webcam?fov=200", "webcam?speed=1"])
def test_names_that_are_wrong(name):
    with pytest.raises(CameraError):
        open_camera(name)


def test_field_of_view():
    _, own = Lens(fov=65.0).see(np.zeros((10, 100, 3), np.uint8))
    assert math.degrees(2 * math.atan(50 / own.fx)) == pytest.approx(65.0)
