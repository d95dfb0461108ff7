"""Visibility of a mesh in depth pictures whose answer is known."""

import numpy as np
import pytest

from igrip.lab.rendering.scene import RenderConfig, random_scene
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import shape_of
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import (
    compare_with_depth,
    local_depth,
    local_depths,
)


@pytest.fixture(scope="module")
def scene(ycb):
    return random_scene(
        ycb, PAPER_OBJECTS[1:], np.random.default_rng(4), config=RenderConfig(noise=None)
    )


def visibility(scene, depth, name, shift=(0, 0, 0), mask=None):
    shape = shape_of(scene.objects[name].model)
    pose = np.linalg.inv(scene.world_from_camera) @ scene.objects[name].pose
    mask = np.zeros(depth.shape, np.uint8) if mask is None else mask
    view = DepthView(
        depth.astype(np.float32), mask, scene.intrinsics, np.eye(4), np.eye(4), 0.001, 0.004
    )
    rotation = np.ascontiguousarray(pose[:3, :3])
    camera_from_mesh = RigidPose(rotation, pose[:3, 3] + np.array(shift))
    return compare_with_depth(view, camera_from_mesh, shape.surface)


@pytest.fixture(scope="module")
def depth(scene):
    return scene.frame(0.0, np.random.default_rng(0)).depth


@pytest.mark.parametrize("name", PAPER_OBJECTS[1:])
def test_the_true_pose_is_seen(scene, depth, name):
    found = visibility(scene, depth, name)
    assert found.match > 0.9
    assert found.fit > 0.85
    assert found.through < 0.03


def test_without_the_object_it_is_seen_through(scene):
    name = "006_mustard_bottle"
    others = {id: placed for id, placed in scene.objects.items() if id != name}
    empty = type(scene)(others, scene.world_from_camera, scene.intrinsics, scene.config)
    found = visibility(scene, empty.frame(0.0, np.random.default_rng(0)).depth, name)
    assert found.through > 0.6
    assert found.match < 0.3  # only where it touches the table


def test_a_wall_or_a_hand_before_it_hides_it(scene, depth):
    name = "006_mustard_bottle"
    assert visibility(scene, np.full_like(depth, 0.3), name).hidden == pytest.approx(1.0)
    assert visibility(scene, depth, name, mask=np.ones(depth.shape, np.uint8)).hidden == 1.0


def test_holes_and_edges_say_nothing(scene, depth):
    name = "006_mustard_bottle"
    assert visibility(scene, np.zeros_like(depth), name).missing == pytest.approx(1.0)
    assert visibility(scene, depth, name, shift=(5.0, 0, 0)).outside == pytest.approx(1.0)
    assert visibility(scene, depth, name, shift=(0, 0, -5.0)).outside == pytest.approx(1.0)


def test_shares_add_up(scene, depth):
    found = visibility(scene, depth, "021_bleach_cleanser", shift=(0.02, 0, 0.01))
    assert (
        found.match + found.through + found.hidden + found.missing + found.outside
        == pytest.approx(1.0)
    )
    assert found.fit <= found.match


def test_local_depth_is_a_mean_of_the_same_surface():
    picture = np.full((20, 20), 1.0, np.float32)
    picture[:, 10:] = 1.5
    picture[5, 5] = 0.0
    picture[8, 6] = 1.009
    assert local_depth(picture, 5, 5) == 0.0
    assert local_depth(picture, 9, 15) == 1.0  # the far side beside it does not count
    assert local_depth(picture, 6, 8) == pytest.approx(1.001, abs=1e-6)
    out = np.empty((10, 10))
    local_depths(picture, 2, 0.2, 1.2, out)
    assert (out[:, 5:] == 0.0).all()  # out of reach
