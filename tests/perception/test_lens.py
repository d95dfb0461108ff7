"""The lens of a camera: its file, its field of view, and rectification."""

import json
import math

import cv2
import numpy as np
import pytest

from igrip.errors import CameraError
from igrip.perception.lens import Rectifier


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
    colour, own = Rectifier(str(tmp_path / "lens.json")).rectify(picture)
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
        Rectifier(str(tmp_path / "lens.json"))


def test_a_picture_of_another_shape(tmp_path):
    told = {"width": 64, "height": 48, "fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5}
    (tmp_path / "lens.json").write_text(json.dumps(told))
    with pytest.raises(CameraError, match="the picture is 64 × 64"):
        Rectifier(str(tmp_path / "lens.json")).rectify(np.zeros((64, 64, 3), np.uint8))


def test_field_of_view():
    _, own = Rectifier(fov=65.0).rectify(np.zeros((10, 100, 3), np.uint8))
    assert math.degrees(2 * math.atan(50 / own.fx)) == pytest.approx(65.0)
