"""Poses on a table, against matrices."""

import numpy as np
import pytest

from igrip.perception.scan.planar_pose import PlanarPose, turned_about, wrapped

POINTS = np.array([[0.1, 0.2, 0.3], [-0.4, 0.0, 0.05], [0.0, 0.0, 0.0]])
POSE = PlanarPose(0.7, 0.1, -0.2)


def matrix(yaw, x, y):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


def applied(pose, points):
    return (np.column_stack([points, np.ones(len(points))]) @ pose.T)[:, :3]


def test_it_is_its_matrix_and_back():
    np.testing.assert_allclose(POSE.apply(POINTS), applied(matrix(0.7, 0.1, -0.2), POINTS))
    np.testing.assert_allclose(POSE.to_table(POSE.apply(POINTS)), POINTS, atol=1e-12)
    np.testing.assert_allclose(POSE.turn(POINTS), applied(matrix(0.7, 0, 0), POINTS))


def test_a_move_comes_after_the_pose():
    moved = matrix(0.3, 0.05, 0.02) @ matrix(0.7, 0.1, -0.2)
    np.testing.assert_allclose(POSE.moved(0.3, 0.05, 0.02).apply(POINTS), applied(moved, POINTS))


def test_a_turn_about_a_point_leaves_it_where_it_is():
    centre = np.array([[0.12, 0.34, 0.5]])
    turned = turned_about(POSE, 1.1, centre[0])
    np.testing.assert_allclose(turned.apply(POSE.to_table(centre)), centre, atol=1e-12)
    assert turned.yaw == pytest.approx(1.8)


def test_angles_are_wrapped():
    assert wrapped(3.5 * np.pi) == pytest.approx(-0.5 * np.pi)
    assert wrapped(-0.1) == pytest.approx(-0.1)
