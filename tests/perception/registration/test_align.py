"""Fits of a mesh to points of its own surface."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.perception.registration.align import align, turn
from igrip.perception.registration.shape import shape_of


def test_a_turn_is_the_rotation_by_that_vector():
    random = np.random.default_rng(0)
    rotation = Rotation.random(random_state=1).as_matrix()
    translation, about, w, shift = random.normal(size=(4, 3))
    point = random.normal(size=3)
    before = rotation @ point + translation
    turned = Rotation.from_rotvec(w).as_matrix() @ (before - about) + about + shift
    turn(rotation, translation, about, w, shift)
    np.testing.assert_allclose(rotation @ point + translation, turned, atol=1e-12)


@pytest.mark.parametrize("name", ["003_cracker_box", "006_mustard_bottle", "035_power_drill"])
@pytest.mark.parametrize("seed", range(3))
def test_a_displaced_mesh_comes_back_to_its_points(ycb, name, seed):
    random = np.random.default_rng(seed)
    shape = shape_of(ycb[name])
    true = Rotation.random(random_state=seed).as_matrix()
    place = random.normal(0, 0.3, 3)
    points = shape.samples @ true.T + place + random.normal(0, 0.001, shape.samples.shape)
    off = Rotation.from_rotvec(random.normal(0, 0.07, 3)).as_matrix()
    rotation = off @ true
    translation = place + random.normal(0, 0.01, 3) + (np.eye(3) - off) @ (true @ shape.middle)
    information = np.empty((6, 6))
    rms, weight = align(
        points, *shape.field, shape.middle, rotation, translation, 6, 0.0, np.zeros(3), 0.0,
        shape.radius, 0.04, 0.01, 20, information,
    )  # fmt: skip
    assert rms < 0.002
    assert weight > 0.5 * len(points)
    middle = rotation @ shape.middle + translation - (true @ shape.middle + place)
    assert np.linalg.norm(middle) < 0.002
    assert np.degrees(Rotation.from_matrix(rotation.T @ true).magnitude()) < 2.0
    np.testing.assert_allclose(information, information.T)


def test_only_x_y_and_the_turn_about_z_may_be_free(ycb):
    shape = shape_of(ycb["003_cracker_box"])
    points = shape.samples + [0.01, -0.01, 0.02]
    rotation, translation = np.eye(3), np.zeros(3)
    align(
        points, *shape.field, shape.middle, rotation, translation, 3, 0.0, np.zeros(3), 0.0,
        shape.radius, 0.05, 0.03, 15, np.empty((6, 6)),
    )  # fmt: skip
    np.testing.assert_allclose(rotation[2], [0, 0, 1], atol=1e-12)
    assert translation[2] == 0.0
    np.testing.assert_allclose(translation[:2], [0.01, -0.01], atol=0.003)


def test_the_wish_to_rest_holds_what_points_leave_open(ycb):
    shape = shape_of(ycb["003_cracker_box"])
    front = shape.samples[shape.normals[:, 0] > 0.9]  # one side: height and tilt along it are open
    rotation, translation = np.eye(3), np.array([0.0, 0.0, 0.006])
    align(
        front, *shape.field, shape.middle, rotation, translation, 6, 0.3,
        np.array([0.0, 0.0, 1.0]), shape.middle[2], shape.radius, 0.03, 0.02, 20,
        np.empty((6, 6)),
    )  # fmt: skip
    middle = rotation @ shape.middle + translation
    assert abs(middle[2] - shape.middle[2]) < 0.002


def test_no_points_no_fit(ycb):
    shape = shape_of(ycb["003_cracker_box"])
    rms, weight = align(
        np.empty((0, 3)), *shape.field, shape.middle, np.eye(3), np.zeros(3), 6, 0.0, np.zeros(3),
        0.0, shape.radius, 0.04, 0.01, 5, np.empty((6, 6)),
    )  # fmt: skip
    assert rms == np.inf
    assert weight == 0.0
