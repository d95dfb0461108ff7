"""The compiled renderer against slabs computed in numpy."""

import numpy as np
import pytest

from igrip import load_objects
from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import OAK, RenderConfig, RenderedScene

SIZE = np.array([0.07, 0.16, 0.21])
SMALL = OAK.scaled(160, 100)


@pytest.fixture(scope="module")
def box():
    return load_objects("box:0.07x0.16x0.21")["box:0.07x0.16x0.21"]


def lines(camera):
    u, v = np.meshgrid(np.arange(SMALL.width), np.arange(SMALL.height))
    x, y = (u - SMALL.cx) / SMALL.fx, (v - SMALL.cy) / SMALL.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    return rays @ camera[:3, :3].T


def slab_depth(camera, pose):
    """Depth of the box where a line of sight enters all three slabs; infinity elsewhere."""
    origin = pose[:3, :3].T @ (camera[:3, 3] - pose[:3, 3])
    rays = lines(camera) @ pose[:3, :3]
    with np.errstate(divide="ignore"):
        a, b = (-SIZE / 2 - origin) / rays, (SIZE / 2 - origin) / rays
    near, far = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
    return np.where((near <= far) & (near > 0), near, np.inf)


def test_box_and_table_are_where_the_slabs_say(box):
    camera = look_at(np.array([0.1, -0.7, 0.5]), np.array([0.0, 0.0, 0.1]))
    c, s = np.cos(0.5), np.sin(0.5)
    pose = np.array([[c, -s, 0, 0.05], [s, c, 0, 0.02], [0, 0, 1, SIZE[2] / 2], [0, 0, 0, 1.0]])
    scene = RenderedScene({"box": PlacedMesh(box, pose)}, camera, SMALL, RenderConfig(noise=None))
    depth, labels = scene.truth()
    expected = slab_depth(camera, pose)
    assert (labels == 0).sum() > 200
    np.testing.assert_array_equal(labels == 0, np.isfinite(expected))
    np.testing.assert_allclose(depth[labels == 0], expected[labels == 0], atol=1e-9)
    table = labels == -1
    z = -camera[2, 3] / lines(camera)[..., 2]
    np.testing.assert_allclose(depth[table], z[table], atol=1e-9)


def test_the_nearer_of_two_hides_the_other(box):
    camera = look_at(np.array([0.0, -0.8, 0.1]), np.array([0.0, 0.0, 0.1]))
    near, far = np.eye(4), np.eye(4)
    near[:3, 3], far[:3, 3] = [0, -0.2, 0.105], [0, 0.2, 0.105]
    for order in (["near", "far"], ["far", "near"]):
        poses = {"near": near, "far": far}
        objects = {id: PlacedMesh(box, poses[id]) for id in order}
        _, labels = RenderedScene(objects, camera, SMALL, RenderConfig(noise=None)).truth()
        assert labels[SMALL.height // 2, SMALL.width // 2] == order.index("near")


def test_what_is_behind_the_camera_is_not_drawn(box):
    camera = look_at(np.array([0.0, -0.8, 0.1]), np.array([0.0, 0.0, 0.1]))
    behind = np.eye(4)
    behind[:3, 3] = [0, -1.6, 0.105]
    _, labels = RenderedScene({"box": PlacedMesh(box, behind)}, camera, SMALL).truth()
    assert not (labels == 0).any()
