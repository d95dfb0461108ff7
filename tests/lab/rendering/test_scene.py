"""Frames of rendered scenes."""

import numpy as np
import pytest

from igrip.lab.rendering.scene import RenderConfig, colour_of, random_scene
from igrip.objects.catalog import PAPER_OBJECTS
from overlaid_scene import Overlay, overlaid


@pytest.fixture(scope="module")
def scene(ycb):
    return random_scene(ycb, PAPER_OBJECTS, np.random.default_rng(1))


def test_one_seed_one_frame(scene):
    a = scene.frame(1.5, np.random.default_rng(3))
    b = scene.frame(1.5, np.random.default_rng(3))
    np.testing.assert_array_equal(a.depth, b.depth)
    np.testing.assert_array_equal(a.colour, b.colour)
    assert a.t == 1.5
    assert a.colour.shape == (400, 640, 3)
    assert a.colour.dtype == np.uint8
    assert a.depth.dtype == np.float32
    np.testing.assert_array_equal(a.world_from_camera, scene.world_from_camera)


def test_points_of_an_object_lie_on_its_mesh(scene):
    depth, labels = scene.truth()
    for number, placed in enumerate(scene.objects.values()):
        v, u = np.nonzero(labels == number)
        assert len(v) > 100
        points = scene.intrinsics.points(np.stack([u, v], axis=1).astype(float), depth[v, u])
        camera = np.linalg.inv(placed.pose) @ scene.world_from_camera
        local = points @ camera[:3, :3].T + camera[:3, 3]
        low, high = placed.model.vertices.min(axis=0), placed.model.vertices.max(axis=0)
        assert (local >= low - 1e-9).all()
        assert (local <= high + 1e-9).all()


def test_an_overlay_hides_what_is_farther_only(scene):
    quiet = RenderConfig(noise=None, sd_colour=0)
    still = type(scene)(scene.objects, scene.world_from_camera, scene.intrinsics, quiet)
    before, _ = still.truth()
    mask = np.ones((50, 40), dtype=bool)
    mask[:10] = False
    red = np.zeros((50, 40, 3), dtype=np.uint8)
    red[..., 0] = 250
    near = Overlay(red, mask, np.full((50, 40), 0.3), -5, 380)  # sticks out of the picture
    far = Overlay(red, mask, np.full((50, 40), 5.0), 300, 200)
    frame = overlaid(still, [near, far]).frame(0.0, np.random.default_rng(0))
    covered = np.zeros(before.shape, dtype=bool)
    covered[390:, :35] = True
    np.testing.assert_allclose(frame.depth[covered], 0.3, rtol=1e-6)
    assert (frame.colour[covered] == [250, 0, 0]).all()
    others = ~covered & np.isfinite(before)
    np.testing.assert_allclose(frame.depth[others], before[others], rtol=1e-6)


def test_noise_is_as_large_as_a_stereo_cameras(scene):
    depth, labels = scene.truth()
    frame = scene.frame(0.0, np.random.default_rng(0))
    on = (labels == -1) & (frame.depth > 0)
    share = (frame.depth[on] - depth[on]) / depth[on]
    assert 0.002 < np.std(share) < 0.02  # the datasheet: less than 2 %


def test_each_model_has_its_colour():
    colours = [colour_of(name) for name in PAPER_OBJECTS]
    assert len(set(colours)) == 4
    assert colours == [colour_of(name) for name in PAPER_OBJECTS]
