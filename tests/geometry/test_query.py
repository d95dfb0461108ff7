"""Rays and nearest points: against every triangle, and against embree."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from igrip.geometry.bvh import build_bvh
from oracle import meshes
from rays import cast, embree_lengths, nearest, nearest_within, towards
from support import PAPER, soup


def all_margins(corners, origins, directions):
    """Return the oracle's margin of each ray, one origin at a time."""
    return np.array(
        [
            meshes.ray_margins(corners, p, d[None])[0]
            for p, d in zip(origins, directions, strict=True)
        ]
    )


@given(st.integers(0, 10_000), st.integers(1, 60))
def test_rays_against_every_triangle(seed, count):
    rng = np.random.default_rng(seed)
    vertices, faces = soup(rng, count)
    bvh, corners = build_bvh(vertices, faces), vertices[faces]
    origins, directions = towards(rng, corners, 60)
    margins = all_margins(corners, origins, directions)
    assert np.abs(margins).min() > 1e-10
    lengths = cast(bvh, origins, directions)
    assert (np.isfinite(lengths) == (margins >= 0.0)).all()
    assert (np.isfinite(cast(bvh, origins, directions, any_hit=True)) == (margins >= 0)).all()
    for k in range(60):
        expected = meshes.ray_lengths(corners, origins[k], directions[k : k + 1])[0]
        assert lengths[k] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", PAPER)
def test_rays_against_embree(ycb, name):
    """Embree works in single precision: where it disagrees, the ray grazes an edge."""
    model = ycb[name]
    rng = np.random.default_rng(1)
    corners = model.vertices[model.faces]
    origins, directions = towards(rng, corners, 4000, spread=2.0)
    ours, theirs = (
        cast(model.bvh, origins, directions),
        embree_lengths(corners, origins, directions),
    )
    differ = np.flatnonzero(np.isfinite(ours) != np.isfinite(theirs))
    assert 500 < np.isfinite(ours).sum() < 3500
    assert len(differ) <= 8  # 0.2 %
    if len(differ):
        assert np.abs(all_margins(corners, origins[differ], directions[differ])).max() < 1e-2
    both = np.isfinite(ours) & np.isfinite(theirs)
    close = np.isclose(ours[both], theirs[both], rtol=1e-4, atol=1e-5)
    assert (~close).sum() <= 8  # it slipped past the edge of a nearer triangle


@pytest.mark.parametrize("name", PAPER)
def test_nearest_vertex_against_a_tree_of_points(ycb, name):
    model = ycb[name]
    rng = np.random.default_rng(2)
    points = model.centre + rng.normal(0.0, 0.1, (300, 3))
    expected, _ = cKDTree(model.vertices).query(points)
    ours = [nearest(model.bvh, point)[0] for point in points]
    assert ours == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", PAPER)
def test_nearest_surface_point_of_real_meshes(ycb, name):
    model = ycb[name]
    rng = np.random.default_rng(3)
    corners = model.vertices[model.faces]
    for point in model.centre + rng.normal(0.0, 0.08, (12, 3)):
        expected, where = meshes.nearest_surface(corners, point)
        for vertices in (True, False):
            vertex, surface, found = nearest(model.bvh, point, vertices)
            assert surface == pytest.approx(expected, rel=1e-9)
            assert found == pytest.approx(where, abs=1e-9)
            assert vertex >= surface


@given(st.integers(0, 10_000), st.integers(1, 60))
def test_nearest_against_every_triangle(seed, count):
    rng = np.random.default_rng(seed)
    vertices, faces = soup(rng, count)
    bvh, corners = build_bvh(vertices, faces), vertices[faces]
    for point in rng.normal(0.0, 0.2, (10, 3)):
        vertex, surface, found = nearest(bvh, point)
        expected, _ = meshes.nearest_surface(corners, point)
        assert surface == pytest.approx(expected, rel=1e-9, abs=1e-15)
        assert np.linalg.norm(found - point) == pytest.approx(surface, rel=1e-12)
        assert vertex == pytest.approx(np.linalg.norm(vertices - point, axis=1).min(), rel=1e-12)
        assert nearest(bvh, point, vertices=False)[1] == pytest.approx(expected, rel=1e-9)


def test_vertex_is_infinite_when_it_is_not_asked_for():
    vertices, faces = soup(np.random.default_rng(0), 5)
    assert nearest(build_bvh(vertices, faces), (0, 0, 0), vertices=False)[0] == np.inf


def tube():
    """Return a closed tube of long slivers, whose vertices lie far from its middle."""
    return trimesh.creation.cylinder(0.03, 0.4, sections=12)


def test_nearest_vertex_may_belong_to_another_triangle_than_the_nearest_point():
    mesh = tube()
    bvh = build_bvh(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    vertex, surface, _ = nearest(bvh, (0.05, 0.0, 0.0))
    assert surface < 0.021
    assert vertex == pytest.approx(np.linalg.norm(mesh.vertices - [0.05, 0, 0], axis=1).min())
    assert vertex > 0.2


DIAGONAL = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize("part", [0.1, 0.25, 0.5, 1 / 3, 0.77])
def test_no_ray_slips_through_a_shared_edge(part):
    rng = np.random.default_rng(int(100 * part))
    turned = DIAGONAL + 0.001
    bvh = build_bvh(turned, HALVES)
    target = turned[0] + part * (turned[2] - turned[0])
    origins = rng.normal(0.0, 2.0, (200, 3))
    assert np.isfinite(cast(bvh, origins, target - origins)).all()


@pytest.mark.parametrize("direction", [(0, 0, -1), (0, -1, 0), (-1, 0, 0), (0, 0, 1)])
def test_rays_along_the_axes_of_boxes(direction):
    """Zero components, also with the origin in the plane of a face of the box."""
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    bvh = build_bvh(np.asarray(box.vertices), np.asarray(box.faces))
    direction = np.array(direction, dtype=float)
    inside = np.array([[0.3, 0.2, 0.1]])
    assert cast(bvh, inside, direction[None])[0] == pytest.approx(1.0 - inside[0] @ direction)
    before = inside - 5.0 * direction
    assert cast(bvh, before, direction[None])[0] == pytest.approx(4.0 - inside[0] @ direction)
    assert cast(bvh, inside + 5.0 * direction, direction[None])[0] == np.inf
    beside = before + 3.0 * np.roll(direction, 1)
    assert cast(bvh, beside, direction[None])[0] == np.inf


def test_a_ray_starts_at_its_origin():
    corners = np.array([[[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]]])
    bvh = build_bvh(corners.reshape(-1, 3), np.array([[0, 1, 2]]))
    up = np.array([[0.0, 0.0, 1.0]])
    assert cast(bvh, np.array([[0.0, 0.0, -2.0]]), up)[0] == pytest.approx(2.0)
    assert cast(bvh, np.array([[0.0, 0.0, 1e-9]]), up)[0] == np.inf
    assert cast(bvh, np.array([[0.0, 0.0, 0.0]]), up)[0] == 0.0


@given(st.integers(0, 10_000), st.floats(1e-3, 1e3))
def test_lengths_are_in_units_of_the_direction(seed, scale):
    rng = np.random.default_rng(seed)
    vertices, faces = soup(rng, 30)
    bvh = build_bvh(vertices, faces)
    origins, directions = towards(rng, vertices[faces], 20)
    plain, scaled = cast(bvh, origins, directions), cast(bvh, origins, scale * directions)
    assert scaled * scale == pytest.approx(plain, rel=1e-9)


def test_a_point_on_the_mesh_and_one_very_far():
    mesh = trimesh.creation.icosphere(2, 0.1)
    bvh = build_bvh(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    on = mesh.triangles.mean(axis=1)[7]
    assert nearest(bvh, on)[1] == pytest.approx(0.0, abs=1e-15)
    assert nearest(bvh, mesh.vertices[5])[0] == 0.0
    far = np.array([1e6, 0.0, 0.0])
    expected = np.linalg.norm(mesh.vertices - far, axis=1).min()
    assert nearest(bvh, far)[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", PAPER)
def test_bounds_known_beforehand_save_work_and_change_nothing(ycb, name):
    """Bounds from a point nearby, as the kernel gives them."""
    model = ycb[name]
    rng = np.random.default_rng(5)
    free = bounded = 0
    for point in model.centre + rng.normal(0.0, 0.3, (100, 3)):
        before = point + rng.normal(0.0, 0.05, 3)
        _, _, surface, vertex, _ = nearest_within(model.bvh, before, np.inf, np.inf)
        plain = nearest_within(model.bvh, point, np.inf, np.inf)
        bounds = [((x - point) ** 2).sum() * (1 + 1e-12) + 1e-300 for x in (vertex, surface)]
        within = nearest_within(model.bvh, point, *bounds)
        assert within[:2] == plain[:2]
        np.testing.assert_array_equal(within[2], plain[2])
        np.testing.assert_array_equal(within[3], plain[3])
        free, bounded = free + plain[4], bounded + within[4]
    assert bounded < free
