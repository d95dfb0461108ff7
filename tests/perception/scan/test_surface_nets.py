"""The mesh of a body whose distances are known."""

import numpy as np
import trimesh

from igrip.perception.scan.fuse import Body
from igrip.perception.scan.surface_nets import mesh_of

CELL = 0.002


def body(distance):
    """The body of a function of points (…, 3) [m]."""
    axis = CELL * np.arange(-30, 31)
    places = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    return Body(distance(places) / CELL, np.full(3, axis[0]), CELL)


def test_a_ball_is_closed_outward_and_of_its_size():
    mesh = mesh_of(body(lambda p: np.linalg.norm(p, axis=-1) - 0.04))
    assert mesh.is_volume
    radii = np.linalg.norm(mesh.vertices, axis=1)
    assert abs(radii - 0.04).max() < 0.1 * CELL
    np.testing.assert_allclose(mesh.volume, 4 / 3 * np.pi * 0.04**3, rtol=0.01)  # positive: outward


def test_a_ring_keeps_its_hole():
    def ring(p):
        return np.hypot(np.hypot(p[..., 0], p[..., 1]) - 0.035, p[..., 2]) - 0.012

    mesh = mesh_of(body(ring))
    assert mesh.is_volume
    assert mesh.euler_number == 0
    assert trimesh.proximity.closest_point(mesh, [[0.0, 0.0, 0.0]])[1][0] > 0.02
