"""Nearest points: against every triangle, and against a tree of points."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from igrip.mesh.bvh import build_bvh, build_point_tree
from oracle import meshes
from rays import nearest
from support import PAPER, soup


@pytest.mark.parametrize("name", PAPER)
def test_nearest_vertex_against_a_tree_of_points(ycb, name):
    model = ycb[name]
    rng = np.random.default_rng(2)
    points = model.centre + rng.normal(0.0, 0.1, (300, 3))
    expected, which = cKDTree(model.vertices).query(points)
    for point, distance, vertex in zip(points, expected, model.vertices[which], strict=True):
        ours, where, _ = nearest(model.vertex_tree, point)
        assert ours == pytest.approx(distance, rel=1e-12)
        assert np.linalg.norm(where - point) == pytest.approx(np.linalg.norm(vertex - point))


@pytest.mark.parametrize("name", PAPER)
def test_nearest_surface_point_of_real_meshes(ycb, name):
    model = ycb[name]
    rng = np.random.default_rng(3)
    corners = model.vertices[model.faces]
    for point in model.centre + rng.normal(0.0, 0.08, (12, 3)):
        expected, where = meshes.nearest_surface(corners, point)
        surface, found, _ = nearest(model.bvh, point)
        assert surface == pytest.approx(expected, rel=1e-9)
        assert found == pytest.approx(where, abs=1e-9)
        assert nearest(model.vertex_tree, point)[0] >= surface


@given(st.integers(0, 10_000), st.integers(1, 60))
def test_nearest_against_every_triangle(seed, count):
    rng = np.random.default_rng(seed)
    vertices, faces = soup(rng, count)
    bvh, corners, points = build_bvh(vertices, faces), vertices[faces], build_point_tree(vertices)
    for point in rng.normal(0.0, 0.2, (10, 3)):
        surface, found, _ = nearest(bvh, point)
        expected, _ = meshes.nearest_surface(corners, point)
        assert surface == pytest.approx(expected, rel=1e-9, abs=1e-15)
        assert np.linalg.norm(found - point) == pytest.approx(surface, rel=1e-12)
        closest = np.linalg.norm(vertices - point, axis=1).min()
        assert nearest(points, point)[0] == pytest.approx(closest, rel=1e-12)


def test_nearest_vertex_may_belong_to_another_triangle_than_the_nearest_point():
    tube = trimesh.creation.cylinder(0.03, 0.4, sections=12)  # long slivers
    bvh = build_bvh(np.asarray(tube.vertices), np.asarray(tube.faces))
    vertex = nearest(build_point_tree(np.asarray(tube.vertices)), (0.05, 0.0, 0.0))[0]
    assert nearest(bvh, (0.05, 0.0, 0.0))[0] < 0.021
    assert vertex == pytest.approx(np.linalg.norm(tube.vertices - [0.05, 0, 0], axis=1).min())
    assert vertex > 0.2


@pytest.mark.parametrize("copies", [1, 9, 1000])
def test_vertices_in_one_place(copies):
    tree = build_point_tree(np.tile([[1.0, 2.0, 3.0]], (copies, 1)))
    assert nearest(tree, (1.0, 2.0, 5.0))[0] == 2.0


def test_a_point_on_the_mesh_and_one_very_far():
    mesh = trimesh.creation.icosphere(2, 0.1)
    bvh = build_bvh(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    points = build_point_tree(np.asarray(mesh.vertices))
    on = mesh.triangles.mean(axis=1)[7]
    assert nearest(bvh, on)[0] == pytest.approx(0.0, abs=1e-15)
    assert nearest(points, mesh.vertices[5])[0] == 0.0
    far = np.array([1e6, 0.0, 0.0])
    expected = np.linalg.norm(mesh.vertices - far, axis=1).min()
    assert nearest(points, far)[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("tree", ["bvh", "vertex_tree"])
@pytest.mark.parametrize("name", PAPER)
def test_bounds_known_beforehand_save_work_and_change_nothing(ycb, name, tree):
    """Bounds from a point nearby, as the kernel gives them."""
    tree = getattr(ycb[name], tree)
    rng = np.random.default_rng(5)
    free = bounded = 0
    for point in ycb[name].centre + rng.normal(0.0, 0.3, (100, 3)):
        before = nearest(tree, point + rng.normal(0.0, 0.05, 3))[1]
        distance, where, nodes = nearest(tree, point)
        within = nearest(tree, point, ((before - point) ** 2).sum() * (1 + 1e-12) + 1e-300)
        assert within[0] == distance
        np.testing.assert_array_equal(within[1], where)
        free, bounded = free + nodes, bounded + within[2]
    assert bounded < free


def test_a_triangle_whose_corners_coincide_is_a_line():
    """Each pair of its corners in one place: no edge of length zero may give a NaN."""
    a, b = np.zeros(3), np.array([0.1, 0.0, 0.0])
    rng = np.random.default_rng(6)
    for corners in ([a, a, b], [a, b, a], [b, a, a], [b, b, a]):
        bvh = build_bvh(np.array(corners), np.array([[0, 1, 2]]))
        for point in rng.normal(0.0, 0.1, (40, 3)):
            foot = np.clip(point[0], 0.0, 0.1) * np.array([1.0, 0.0, 0.0])
            distance, where, _ = nearest(bvh, point)
            assert distance == pytest.approx(np.linalg.norm(point - foot), rel=1e-12)
            assert where == pytest.approx(foot, abs=1e-15)


def test_a_tree_of_one_node_is_visited_once():
    bvh = build_bvh(np.eye(3), np.array([[0, 1, 2]]))
    assert len(bvh.boxes) == 1
    assert nearest(bvh, (0.0, 0.0, 0.0))[2] == 1
