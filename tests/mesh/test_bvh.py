"""The tree itself: nothing lost, nothing twice, every box outside its triangles."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from igrip.mesh.bvh import LEAF_BITS, STACK, TRIANGLES_IN_LEAF, build_bvh
from oracle.meshes import ray_lengths
from rays import cast, nearest
from support import PAPER, mesh_of, soup


def walk(bvh):
    """Yield (node, child, depth, first, last) of every child; first and last for a leaf only."""
    todo, seen = [(0, 0)], set()
    while todo:
        node, depth = todo.pop()
        assert node not in seen
        seen.add(node)
        for child in range(2):
            link = int(bvh.links[node, child])
            if link >= 0:
                todo.append((link, depth + 1))
                yield node, child, depth, None, None
            else:
                first, count = divmod(-1 - link, 1 << LEAF_BITS)
                yield node, child, depth, first, first + count
    assert seen == set(range(len(bvh.boxes)))


def check(vertices, faces):
    """Assert every invariant of a tree; return its depth."""
    bvh = build_bvh(vertices, faces)
    given_triangles = sorted(map(tuple, vertices[faces].reshape(-1, 9)))
    assert sorted(map(tuple, bvh.leaves)) == given_triangles
    times_in_leaf = np.zeros(len(faces), dtype=int)
    inside = {}  # node → the range of triangles below it
    rows = list(walk(bvh))
    for node, child, _depth, first, last in sorted(rows, key=lambda row: -row[2]):
        if first is None:
            first, last = inside[int(bvh.links[node, child])]
        else:
            assert last - first <= TRIANGLES_IN_LEAF
            times_in_leaf[first:last] += 1
        low, high = inside.get(node, (first, last))
        inside[node] = min(low, first), max(high, last)
        if first == last:
            continue
        corners = bvh.leaves[first:last].reshape(-1, 3)
        box = bvh.boxes[node, 6 * child : 6 * child + 6].astype(float)
        assert (box[:3] <= corners.min(axis=0)).all()
        assert (box[3:] >= corners.max(axis=0)).all()
        slack = 3e-7 * max(1.0, np.abs(corners).max())  # rounded outward, but no further
        assert (box[:3] >= corners.min(axis=0) - slack).all()
        assert (box[3:] <= corners.max(axis=0) + slack).all()
    assert (times_in_leaf == 1).all()
    depth = 1 + max(row[2] for row in rows)
    assert depth < STACK
    return depth


@pytest.mark.parametrize("name", PAPER)
def test_real_meshes(ycb, name):
    model = ycb[name]
    assert check(model.vertices, model.faces) < 40


@given(st.integers(0, 10_000), st.integers(1, 80))
def test_any_heap_of_triangles(seed, count):
    check(*soup(np.random.default_rng(seed), count))


DEGENERATE = {
    "one triangle": np.eye(3)[None],
    "two triangles": np.stack([np.eye(3), np.eye(3) + 1.0]),
    "five identical": np.repeat(np.eye(3)[None], 5, axis=0),
    "thousand identical": np.repeat(np.eye(3)[None], 1000, axis=0),
    "in a line": np.eye(3)[None] + np.arange(50)[:, None, None] * [1.0, 0.0, 0.0],
    "needles": np.cumsum(np.full((40, 3, 3), 1e-3), axis=0) * [1.0, 1e-12, 1e-12],
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate(name):
    corners = DEGENERATE[name]
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    check(corners.reshape(-1, 3), faces)


def test_flat_mesh():
    x, y = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 9))
    vertices = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.25)], axis=1)
    row, column = np.meshgrid(np.arange(8), np.arange(11), indexing="ij")
    a = (row * 12 + column).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + 13], 1), np.stack([a, a + 13, a + 12], 1)])
    check(vertices, faces)
    bvh = build_bvh(vertices, faces)
    origins = np.array([[0.31, 0.47, 2.0], [0.31, 0.47, 0.0], [0.31, 1.47, 2.0]])
    directions = np.array([[0, 0, -1.0], [0, 0, 1.0], [0, 0, -1.0]])
    assert cast(bvh, origins, directions).tolist() == [1.75, 0.25, np.inf]
    assert nearest(bvh, (0.3, 0.4, 0.75))[0] == pytest.approx(0.5)


def test_ten_thousand_coincident_centres():
    rng = np.random.default_rng(0)
    count = 10_000
    half = rng.uniform(1e-6, 0.1, (count, 3))
    corners = np.stack([-half, half * [1, 1, -1], half], axis=1)  # every box is centred on 0
    vertices, faces = corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)
    assert check(vertices, faces) <= 16  # halved: 2 ** 12 leaves of four, and some slack
    bvh = build_bvh(vertices, faces)
    origin, direction = np.array([[0.0, 0.001, 1.0]]), np.array([[1e-3, 0.0, -1.0]])
    expected = ray_lengths(corners, origin[0], direction)
    assert cast(bvh, origin, direction) == pytest.approx(expected, rel=1e-9)


def test_sizes_over_many_orders_of_magnitude_do_not_make_the_tree_too_deep():
    scale = 2.0 ** -np.arange(0, 800, 0.25)
    corners = scale[:, None, None] * np.array([[1.0, 0.9, 0.9], [0.9, 1.0, 0.9], [0.9, 0.9, 1.0]])
    vertices, faces = corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)
    assert check(vertices, faces) < 48 + 14


def test_far_from_the_origin_boxes_still_contain():
    vertices, faces = soup(np.random.default_rng(2), 40)
    check(vertices + [1e4, -1e5, 33.3], faces)


def test_order_of_faces_does_not_change_what_is_found():
    rng = np.random.default_rng(3)
    vertices, faces = soup(rng, 50)
    mixed = faces[rng.permutation(len(faces))][:, [1, 2, 0]]
    a, b = build_bvh(vertices, faces), build_bvh(vertices, mixed)
    origins, directions = rng.normal(0, 0.5, (2, 300, 3))
    assert cast(a, origins, directions) == pytest.approx(cast(b, origins, directions), rel=1e-9)
    for point in origins[:50]:
        assert nearest(a, point)[0] == pytest.approx(nearest(b, point)[0], rel=1e-12)


def test_building_twice_gives_the_same_bits():
    mesh = trimesh.creation.icosphere(2, 0.1)
    trees = [build_bvh(mesh.vertices.view(np.ndarray), mesh.faces) for _ in range(2)]
    for a, b in zip(*trees, strict=True):
        assert (a == b).all()


def test_the_input_is_left_alone():
    mesh = mesh_of(*soup(np.random.default_rng(5), 20))
    vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
    build_bvh(vertices, faces)
    assert (vertices == mesh.vertices).all()
    assert (faces == mesh.faces).all()
