"""StablePoses poses: of shapes whose ways of resting can be counted."""

import numpy as np
import trimesh

from igrip.objects.stable_poses import stable_poses


def test_a_box_rests_on_its_six_faces_the_widest_most_often():
    size = np.array([0.07, 0.16, 0.21])
    mesh = trimesh.creation.box(extents=size)
    ways = stable_poses(mesh.vertices, np.zeros(3))
    assert len(ways.heights) == 6
    up = np.abs(ways.rotations[:, 2]).round(6)
    assert sorted(map(tuple, up)) == sorted([(1, 0, 0), (0, 1, 0), (0, 0, 1)] * 2)
    for way, height, chance in zip(ways.rotations, ways.heights, ways.probabilities, strict=True):
        axis = int(np.argmax(np.abs(way[2])))
        assert abs(height - size[axis] / 2) < 1e-9
        if axis == 0:
            assert chance > 0.2  # the thinnest way up
    np.testing.assert_allclose(ways.rotations[0], np.eye(3), atol=1e-9)  # as its file stands


def test_a_cylinder_stands_on_both_ends_and_lies_all_round():
    mesh = trimesh.creation.cylinder(0.033, 0.1, sections=64)
    ways = stable_poses(mesh.vertices, np.zeros(3))
    standing = np.abs(ways.rotations[:, 2, 2]) > 0.99
    lying = np.abs(ways.rotations[:, 2, 2]) < 0.01
    assert standing.sum() == 2
    assert standing.sum() + lying.sum() == len(ways.heights)
    np.testing.assert_allclose(ways.heights[lying], 0.033, atol=2e-4)
    around = np.sort(np.arctan2(ways.rotations[lying, 2, 1], ways.rotations[lying, 2, 0]))
    gaps = np.diff(np.append(around, around[0] + 2 * np.pi))
    assert np.degrees(gaps.max()) < 75.0


def test_a_way_of_resting_touches_the_table_and_holds_the_centre_over_its_foot(ycb):
    for name in ("006_mustard_bottle", "025_mug", "035_power_drill"):
        model = ycb[name]
        ways = stable_poses(model.vertices, model.centre)
        for rotation, height in zip(ways.rotations, ways.heights, strict=True):
            np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
            points = model.vertices @ rotation.T + [0, 0, height]
            assert abs(points[:, 2].min()) < 1e-9
            low = points[points[:, 2] < 0.006, :2]  # scanned feet are not flat
            centre = (rotation @ model.centre)[:2]
            # no direction in which every point of the foot is on one side of the centre by 2 cm
            angles = np.linspace(0, 2 * np.pi, 36)
            sides = (low - centre) @ np.stack([np.cos(angles), np.sin(angles)])
            assert (sides.max(axis=0) > -0.02).all()
