"""Rays: against every triangle, and against embree."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from igrip.mesh.bvh import build_bvh
from oracle import meshes
from rays import cast, embree_lengths, meets, towards
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
    assert (meets(bvh, origins, directions) == (margins >= 0)).all()
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
