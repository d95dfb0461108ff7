"""What a camera sees: circles are where hands and objects are."""

import io

import numpy as np
from PIL import Image

from igrip import Observation
from igrip.experiment.camera_pictures import OBJECT, camera_picture
from igrip.rgbd import Intrinsics, RgbdFrame

LENS = Intrinsics(1280, 720, 900.0, 900.0, 639.5, 359.5)
POSE = np.array([[1, 0, 0, 0.5], [0, -1, 0, 0.0], [0, 0, -1, 1.0], [0, 0, 0, 1.0]])  # from above


def seen(observation):
    frame = RgbdFrame(1.0, np.zeros((720, 1280, 3), np.uint8), None, LENS, "one", POSE)
    return np.asarray(Image.open(io.BytesIO(camera_picture(frame, observation)))).astype(int)


def test_a_circle_is_where_the_object_is():
    pose = {"position": [0.6, 0.1, 0.0], "orientation": [0, 0, 0, 1], "model": "x"}
    picture = seen(Observation(t=1.0, objects={"mug": pose}))
    assert picture.shape == (360, 640, 3)
    # 1 m below the camera: 900 pixels a metre, at half the size
    near = np.abs(picture - OBJECT[::-1]).sum(axis=2) < 120
    rows, columns = np.nonzero(near)
    assert abs(columns[columns < 380].mean() - (319.5 + 45)) < 2
    assert abs(rows[columns < 380].mean() - (179.5 - 45)) < 2


def test_what_is_not_in_the_picture_is_not_drawn():
    behind = {"position": [0.5, 0.0, 2.0]}
    outside = {"position": [9.0, 0.0, 0.0]}
    picture = seen(Observation(t=1.0, hands={"left": behind, "right": outside}))
    assert picture.max() < 20
    assert seen(None).max() < 20
