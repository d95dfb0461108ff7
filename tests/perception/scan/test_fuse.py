"""The mesh of a body whose distances are known."""

import numpy as np
import pytest
import trimesh
from scipy.ndimage import gaussian_filter

from igrip.perception.scan.fuse import Body, surface_of

CELL = 0.002


def body(distance):
    """The body of a function of points (…, 3) [m]."""
    axis = CELL * np.arange(-30, 31)
    places = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    return Body(distance(places) / CELL, np.full(3, axis[0]), CELL)


def test_a_ball_is_closed_outward_and_of_its_size():
    mesh = surface_of(body(lambda p: np.linalg.norm(p, axis=-1) - 0.04))
    assert mesh.is_volume
    radii = np.linalg.norm(mesh.vertices, axis=1)
    assert abs(radii - 0.04).max() < 0.1 * CELL
    np.testing.assert_allclose(mesh.volume, 4 / 3 * np.pi * 0.04**3, rtol=0.01)  # positive: outward


def test_a_ring_keeps_its_hole():
    def ring(p):
        return np.hypot(np.hypot(p[..., 0], p[..., 1]) - 0.035, p[..., 2]) - 0.012

    mesh = surface_of(body(ring))
    assert mesh.is_volume
    assert mesh.euler_number == 0
    assert trimesh.proximity.closest_point(mesh, [[0.0, 0.0, 0.0]])[1][0] > 0.02


@pytest.mark.parametrize("seed", range(8))
def test_any_body_has_a_closed_surface(seed):
    """Also where solid corners touch across a diagonal alone."""
    values = gaussian_filter(np.random.default_rng(seed).normal(size=(20, 20, 20)), 1.0)
    values -= np.quantile(values, 0.4)
    for axis in range(3):
        for end in (0, -1):
            np.moveaxis(values, axis, 0)[end] = 0.1
    assert surface_of(Body(values, np.zeros(3), CELL)).is_volume
