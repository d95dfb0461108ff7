"""Distance fields against the formula for a box and against points moved off a mesh."""

import numpy as np

from igrip import load_objects
from igrip.mesh.bvh import build_bvh
from igrip.perception.registration.signed_distance import look_up, signed_distance_field

NAME = "box:0.07x0.16x0.21"
HALF = np.array([0.035, 0.08, 0.105])


def distance(points):
    q = np.abs(points) - HALF
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)


def field_of_box():
    model = load_objects(NAME)[NAME]
    return signed_distance_field(model.vertices, model.bvh)


def test_distances_of_a_box():
    field = field_of_box()
    points = np.random.default_rng(0).uniform(-0.13, 0.13, (2000, 3))
    found = field.distances(points)
    inside = (np.abs(points) < HALF + 0.03).all(axis=1)
    error = np.abs(found - distance(points))
    assert error[inside].max() < field.cell
    assert np.percentile(error[inside], 90) < 0.25 * field.cell
    assert error[~inside].max() < 0.04  # beyond the grid it is an upper bound
    assert (found[~inside] > 0).all()


def test_the_gradient_is_that_of_the_distance():
    field = field_of_box()
    gradient, other = np.empty(3), np.empty(3)
    for point in np.random.default_rng(1).uniform(-1, 1, (200, 3)) * (HALF + 0.02):
        here = look_up(*field, *point, gradient)
        step = 1e-4 * gradient
        there = look_up(*field, *(point + step), other)
        if np.allclose(gradient, other, atol=0.05):  # within one cell
            assert abs((there - here) - gradient @ step) < 2e-6


def test_a_mesh_without_a_bottom_has_an_inside(ycb):
    whole = ycb["003_cracker_box"]
    triangles = whole.vertices[whole.faces]
    kept = triangles.mean(axis=1)[:, 2] > whole.vertices[:, 2].min() + 0.003
    field = signed_distance_field(whole.vertices, build_bvh(whole.vertices, whole.faces[kept]))
    assert look_up(*field, *whole.sphere[:3], np.empty(3)) < -0.02
    assert look_up(*field, *(whole.sphere[:3] + [0.06, 0, 0]), np.empty(3)) > 0.01
