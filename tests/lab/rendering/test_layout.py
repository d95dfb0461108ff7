"""Scenes: things rest on the table, apart, and the camera looks at them."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from igrip.lab.rendering.layout import LayoutConfig, look_at, random_camera, scatter
from igrip.objects.catalog import PAPER_OBJECTS


@pytest.mark.parametrize("seed", range(4))
def test_objects_rest_on_the_table_and_keep_apart(ycb, seed):
    placed = scatter(
        [ycb[name] for name in PAPER_OBJECTS],
        LayoutConfig(lying=0.5),
        np.random.default_rng(seed),
    )
    points = [p.model.vertices @ p.pose[:3, :3].T + p.pose[:3, 3] for p in placed]
    for cloud in points:
        assert abs(cloud[:, 2].min()) < 1e-9
    for i, a in enumerate(points):
        for b in points[:i]:
            assert cKDTree(a[:, :2]).query(b[:, :2])[0].min() >= 0.03


def test_too_many_do_not_fit(ycb):
    config = LayoutConfig(width=0.1, depth=0.1)
    with pytest.raises(ValueError, match="no room"):
        scatter([ycb[name] for name in PAPER_OBJECTS], config, np.random.default_rng(0))


def test_a_camera_sees_its_target_in_the_middle_and_stands_level():
    eye, target = np.array([0.3, -0.6, 0.5]), np.array([0.0, 0.1, 0.0])
    pose = look_at(eye, target)
    seen = pose[:3, :3].T @ (target - eye)
    np.testing.assert_allclose(seen, [0, 0, np.linalg.norm(target - eye)], atol=1e-12)
    assert pose[2, 0] == pytest.approx(0.0)  # to the right is level
    assert pose[2, 1] < 0.0  # and down is down
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)


def test_cameras_stand_within_the_ranges():
    config = LayoutConfig()
    for seed in range(20):
        pose = random_camera(config, np.random.default_rng(seed))
        distance = np.linalg.norm(pose[:3, 3] - [0, 0, 0.07])
        assert config.distance[0] <= distance <= config.distance[1]
        down = np.degrees(np.arcsin(-pose[2, 2]))
        assert config.elevation[0] - 1e-9 <= down <= config.elevation[1] + 1e-9
