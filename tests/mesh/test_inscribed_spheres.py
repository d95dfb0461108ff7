"""Balls inside meshes: inside they are, and rays through them meet the mesh by brute force."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from igrip.mesh.bvh import build_bvh
from igrip.mesh.inscribed_spheres import MAX_SPHERES, inscribed_spheres, is_closed
from oracle import meshes
from support import PAPER


def balls_of(mesh):
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    balls = inscribed_spheres(vertices, faces, build_bvh(vertices, faces))
    return balls[balls[:, 3] > 0.0]


def assert_rays_through_them_meet(rng, balls, corners, count=20):
    """From far, from near and from inside, in any direction."""
    for ball in balls:
        inside = ball[:3] + ball[3] * rng.uniform(-0.57, 0.57, (count, 3))
        origins = ball[:3] + rng.normal(0.0, 3.0 * ball[3], (count, 3))
        for p, q in zip(origins, inside, strict=True):
            assert meshes.ray_margins(corners, p, (q - p)[None])[0] >= 0.0
            assert meshes.ray_margins(corners, q, (p - q)[None])[0] >= 0.0


@pytest.mark.parametrize(
    "mesh",
    [
        trimesh.creation.box((0.1, 0.2, 0.3)),
        trimesh.creation.icosphere(3, 0.05),
        trimesh.creation.annulus(0.03, 0.05, 0.1),
    ],
    ids=["box", "ball", "pipe"],
)
def test_they_lie_inside_and_rays_through_them_meet(mesh):
    rng = np.random.default_rng(1)
    balls = balls_of(mesh)
    assert len(balls) >= 1
    shell = rng.normal(size=(200, 3))
    shell /= np.linalg.norm(shell, axis=1)[:, None]
    for ball in balls:  # winding numbers know nothing of how the balls were found
        assert (np.abs(_winding(mesh, ball[:3] + 0.999 * ball[3] * shell)) > 0.9).all()
    assert_rays_through_them_meet(rng, balls, np.asarray(mesh.triangles))


@pytest.mark.parametrize("name", PAPER)
def test_real_objects_have_them(ycb, name):
    model = ycb[name]
    balls = model.inscribed_spheres[model.inscribed_spheres[:, 3] > 0.0]
    assert len(balls) >= 3
    assert balls[0, 3] > 0.5 * min(model.radius, 0.04)
    corners = model.vertices[model.faces]
    assert_rays_through_them_meet(np.random.default_rng(2), balls, corners, 3)


def spheres_of_a_box(extents, shift):
    """Return the spheres of a box by its formula: how deep a point of the grid is."""
    steps = (np.arange(12) + 0.5) / 12 - 0.5
    grid = np.array([(x, y, z) for x in steps for y in steps for z in steps]) * extents
    depth, found = (0.5 * np.array(extents) - np.abs(grid)).min(axis=1), []
    while len(found) < 8:
        deepest = int(np.argmax(np.round(depth, 12)))
        radius = depth[deepest] * (1.0 - 1e-6)
        if found and radius <= 0.15 * found[0][3]:
            break
        found.append((*(grid[deepest] + shift), radius))
        depth[np.linalg.norm(grid - grid[deepest], axis=1) < radius] = 0.0
    return np.array(found)


@pytest.mark.parametrize(
    ("extents", "shift"),
    [((0.06, 0.1, 0.3), (0.2, -0.1, 0.5)), ((0.1, 0.1, 0.1), (0.0, 0.0, 0.0))],
)
def test_those_of_a_box_are_the_deepest_points_of_the_grid(extents, shift):
    box = trimesh.creation.box(extents)
    box.apply_translation(shift)
    ours, expected = balls_of(box), spheres_of_a_box(extents, shift)
    assert ours[:, 3] == pytest.approx(expected[:, 3], rel=1e-9)
    # of points that are equally deep the first of the grid counts, as the last digits have it
    assert len(np.unique(ours.round(9), axis=0)) == len(expected)
    for ball in ours:
        assert (np.abs(ball[:3] - shift) + ball[3] <= 0.5 * np.array(extents)).all()
        others = ours[ours[:, 3] > ball[3]]
        assert (np.linalg.norm(others[:, :3] - ball[:3], axis=1) >= others[:, 3]).all()


def test_the_middle_of_a_pipe_is_outside():
    pipe = trimesh.creation.annulus(0.03, 0.05, 0.1)
    for ball in balls_of(pipe):
        assert 0.03 < np.hypot(*ball[:2]) < 0.05


def test_an_open_mesh_has_none():
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    vertices, faces = np.asarray(box.vertices), np.asarray(box.faces)
    lidless = faces[1:]
    assert is_closed(vertices, faces)
    assert not is_closed(vertices, lidless)
    balls = inscribed_spheres(vertices, lidless, build_bvh(vertices, lidless))
    assert (balls[:, 3] == -1.0).all()
    assert balls.shape == (MAX_SPHERES, 4)


def test_a_seam_of_equal_vertices_is_no_border():
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    vertices = np.asarray(box.vertices)[np.asarray(box.faces)].reshape(-1, 3)  # none shared
    faces = np.arange(len(vertices)).reshape(-1, 3)
    assert is_closed(vertices, faces)


def _winding(mesh, points):
    """Return the generalised winding number of points (Jacobson et al. 2013), solid angle by
    solid angle (van Oosterom & Strackee 1983)."""
    corners = np.asarray(mesh.triangles)[None] - points[:, None, None]
    a, b, c = corners[:, :, 0], corners[:, :, 1], corners[:, :, 2]
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    top = np.einsum("pfi,pfi->pf", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("pfi,pfi->pf", x, y) for x, y in ((a, b), (b, c), (c, a)))
    return np.arctan2(top, la * lb * lc + ab * lc + bc * la + ca * lb).sum(axis=1) / (2.0 * np.pi)


def test_an_edge_of_four_faces_leaves_a_surface_closed():
    """Two tetrahedra that share an edge, but no face."""
    vertices = np.array([
        [0.0, 0, 0], [0, 0, 1], [1, 0, 0.5], [1, 1, 0.5], [-1, 0, 0.5], [-1, -1, 0.5],
    ])  # fmt: skip
    tetrahedron = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
    other = np.array([0, 1, 4, 5])[tetrahedron]
    faces = np.concatenate([tetrahedron, other])
    assert is_closed(vertices, faces)
    assert not is_closed(vertices, faces[1:])
    assert not is_closed(vertices, np.concatenate([faces, [[0, 1, 4]]]))
