"""The plane of the table from points that are half something else."""

import numpy as np
import pytest

from igrip.perception.registration.plane import find_plane


def points_of_plane(normal, offset, random, count=3000, noise=0.0):
    """Points of a plane that a camera at the origin sees, with noise along the line of sight."""
    rays = np.stack(
        [random.uniform(-0.6, 0.6, count), random.uniform(-0.4, 0.4, count), np.ones(count)], axis=1
    )
    z = offset / (rays @ normal)
    return rays * (z * (1 + noise * z * random.standard_normal(count)))[:, None]


@pytest.mark.parametrize("turn", [0.0, 0.7, 3.0])
def test_it_is_found_among_clutter_however_the_camera_is_held(turn):
    random = np.random.default_rng(0)
    c, s = np.cos(turn), np.sin(turn)
    roll = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    down = np.array([0.0, 0.6, 0.8])
    table = points_of_plane(down, 0.5, random, noise=0.004)
    clutter = random.uniform([-0.4, -0.3, 0.4], [0.4, 0.1, 1.0], (1500, 3))
    plane = find_plane(np.concatenate([table, clutter]) @ roll.T, random)
    up = plane.table_from_camera[2, :3]
    assert np.degrees(np.arccos(-up @ (roll @ down))) < 0.5
    assert plane.table_from_camera[2, 3] == pytest.approx(0.5, abs=0.003)  # the camera is above
    assert plane.share == pytest.approx(2 / 3, abs=0.08)
    frame = plane.table_from_camera[:3, :3]
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)


def test_the_noise_is_measured_with_it():
    random = np.random.default_rng(1)
    down = np.array([0.0, 0.6, 0.8])
    points = points_of_plane(down, 0.5, random, noise=0.003)
    plane = find_plane(points, random)
    true = np.median(np.abs(points @ down - 0.5) / points[:, 2] ** 2) * 1.4826
    assert plane.noise == pytest.approx(true, rel=0.1)


def test_where_there_is_none():
    random = np.random.default_rng(2)
    assert find_plane(random.uniform([-1, -1, 0.5], [1, 1, 2.5], (3000, 3)), random) is None
    assert find_plane(np.empty((0, 3)), random) is None
    line = np.outer(np.linspace(0.5, 1.0, 500), [0.1, 0.2, 1.0])
    assert find_plane(line, random) is None or True  # and no error for points on a line
