"""Fits of a mesh to points of its own surface."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.perception.registration.align import Annealing, Resting, align
from igrip.perception.registration.rigid_pose import RigidPose, turn_about
from igrip.perception.registration.shape import shape_of

FREE = Resting(np.zeros(3), 0.0, 0.0)


def test_a_turn_is_the_rotation_by_that_vector():
    random = np.random.default_rng(0)
    rotation = Rotation.random(random_state=1).as_matrix()
    translation, about, w, shift = random.normal(size=(4, 3))
    point = random.normal(size=3)
    before = rotation @ point + translation
    turned = Rotation.from_rotvec(w).as_matrix() @ (before - about) + about + shift
    turn_about(RigidPose(rotation, translation), about, w, shift)
    np.testing.assert_allclose(rotation @ point + translation, turned, atol=1e-12)


@pytest.mark.parametrize("name", ["003_cracker_box", "006_mustard_bottle", "035_power_drill"])
@pytest.mark.parametrize("seed", range(3))
def test_a_displaced_mesh_comes_back_to_its_points(ycb, name, seed):
    random = np.random.default_rng(seed)
    shape = shape_of(ycb[name])
    true = Rotation.random(random_state=seed).as_matrix()
    place = random.normal(0, 0.3, 3)
    samples, centre = shape.surface.points, shape.surface.centre
    points = samples @ true.T + place + random.normal(0, 0.001, samples.shape)
    off = Rotation.from_rotvec(random.normal(0, 0.07, 3)).as_matrix()
    rotation = off @ true
    translation = place + random.normal(0, 0.01, 3) + (np.eye(3) - off) @ (true @ centre)
    information = np.empty((6, 6))
    pose = RigidPose(rotation, translation)
    annealing = Annealing(0.04, 0.01, 20)
    rms, weight = align(points, shape.surface, pose, FREE, False, annealing, information)
    assert rms < 0.002
    assert weight > 0.5 * len(points)
    assert np.linalg.norm(pose.apply(centre) - (true @ centre + place)) < 0.002
    assert np.degrees(Rotation.from_matrix(rotation.T @ true).magnitude()) < 2.0
    np.testing.assert_allclose(information, information.T)


def test_only_x_y_and_the_turn_about_z_may_be_free(ycb):
    surface = shape_of(ycb["003_cracker_box"]).surface
    rotation, translation = pose = RigidPose(np.eye(3), np.zeros(3))
    points = surface.points + [0.01, -0.01, 0.02]
    align(points, surface, pose, FREE, True, Annealing(0.05, 0.03, 15), np.empty((6, 6)))
    np.testing.assert_allclose(rotation[2], [0, 0, 1], atol=1e-12)
    assert translation[2] == 0.0
    np.testing.assert_allclose(translation[:2], [0.01, -0.01], atol=0.003)


def test_resting_holds_what_points_leave_open(ycb):
    surface = shape_of(ycb["003_cracker_box"]).surface
    # one side: height and tilt along it are open
    front = surface.points[surface.normals[:, 0] > 0.9]
    pose = RigidPose(np.eye(3), np.array([0.0, 0.0, 0.006]))
    resting = Resting(np.array([0.0, 0.0, 1.0]), surface.centre[2], 0.3)
    align(front, surface, pose, resting, False, Annealing(0.03, 0.02, 20), np.empty((6, 6)))
    assert abs(pose.apply(surface.centre)[2] - surface.centre[2]) < 0.002


def test_no_points_no_fit(ycb):
    surface = shape_of(ycb["003_cracker_box"]).surface
    pose = RigidPose(np.eye(3), np.zeros(3))
    annealing = Annealing(0.04, 0.01, 5)
    rms, weight = align(np.empty((0, 3)), surface, pose, FREE, False, annealing, np.empty((6, 6)))
    assert rms == np.inf
    assert weight == 0.0
