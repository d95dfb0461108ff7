"""What a camera sees: circles are where hands and objects are."""

import io

import numpy as np
import pytest
from PIL import Image

from igrip import Hand, ObjectPose, load_objects
from igrip.experiment.camera_pictures import OBJECT, camera_picture
from igrip.rgbd import Intrinsics, RgbdFrame

LENS = Intrinsics(1280, 720, 900.0, 900.0, 639.5, 359.5)
POSE = np.array([[1, 0, 0, 0.5], [0, -1, 0, 0.0], [0, 0, -1, 1.0], [0, 0, 0, 1.0]])  # from above


def seen(catalog=None, **entities):
    frame = RgbdFrame(1.0, np.zeros((720, 1280, 3), np.uint8), None, LENS, "one", POSE)
    return np.asarray(Image.open(io.BytesIO(camera_picture(frame, entities, catalog)))).astype(int)


def test_a_circle_is_where_the_object_is():
    pose = ObjectPose(position=(0.6, 0.1, 0.0), orientation=(0, 0, 0, 1), model="x")
    picture = seen(mug=pose)
    assert picture.shape == (360, 640, 3)
    # 1 m below the camera: 900 pixels a metre, at half the size
    assert circle_of(picture) == pytest.approx((319.5 + 45, 179.5 - 45), abs=2)


def test_the_circle_is_at_the_middle_not_at_the_origin_of_the_mesh():
    model = "005_tomato_soup_can"
    catalog = load_objects("ycb")
    middle = catalog[model].sphere[:3]
    assert np.hypot(*middle[:2]) > 0.05  # this mesh has its origin beside the can
    pose = ObjectPose(position=tuple((0.6, 0.1, 0.0) - middle), orientation=(0, 0, 0, 1),
                      model=model)  # fmt: skip
    assert circle_of(seen(catalog, soup=pose)) == pytest.approx((319.5 + 45, 179.5 - 45), abs=2)


def circle_of(picture):
    near = np.abs(picture - OBJECT[::-1]).sum(axis=2) < 120
    rows, columns = np.nonzero(near)
    left = columns < 380  # of the name
    return columns[left].mean(), rows[left].mean()


def test_what_is_not_in_the_picture_is_not_drawn():
    behind, outside = Hand(position=(0.5, 0.0, 2.0)), Hand(position=(9.0, 0.0, 0.0))
    assert seen(left=behind, right=outside).max() < 20
    assert seen().max() < 20
