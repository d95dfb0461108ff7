"""Every split of a tree is where the binned surface-area heuristic is least, by plain numpy."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.mesh.bvh import LEAF_BITS, POINTS_IN_LEAF, TRIANGLES_IN_LEAF, build_bvh, build_point_tree
from support import soup

BINS = 16


def area(lower, upper):
    """Return half of the surface of the box around some boxes."""
    x, y, z = upper.max(axis=0) - lower.min(axis=0)
    return x * y + y * z + z * x


def best_split(lower, upper):
    """Return which things go left; None where no plane between bins separates any."""
    centres = lower + upper
    low, width = centres.min(axis=0), np.ptp(centres, axis=0)
    best, chosen = np.inf, None
    for axis in range(3):
        if width[axis] <= 0.0:
            continue
        bins = np.minimum(
            BINS - 1, (BINS * (centres[:, axis] - low[axis]) / width[axis]).astype(int)
        )
        for cut in range(BINS - 1):
            left = bins <= cut
            if not left.any() or left.all():
                continue
            cost = left.sum() * area(lower[left], upper[left])
            cost += (~left).sum() * area(lower[~left], upper[~left])
            if cost < best - 1e-12 * abs(cost):
                best, chosen = cost, left
    return chosen


def ranges(tree):
    """Return the first and last leaf below each node and child."""
    found = {}

    def of(node):
        for child in range(2):
            link = int(tree.links[node, child])
            if link >= 0:
                of(link)
                found[node, child] = (found[link, 0][0], found[link, 1][1])
            else:
                first, count = divmod(-1 - link, 1 << LEAF_BITS)
                found[node, child] = (first, first + count)

    of(0)
    return found


def check(tree, corners, in_leaf):
    """Compare every split of more things than fit in a leaf with the heuristic."""
    checked = 0
    for (node, child), (first, last) in ranges(tree).items():
        if child == 1:
            continue
        end = ranges(tree)[node, 1][1]
        things = corners[first:end]
        if len(things) <= in_leaf:
            continue
        left = best_split(things.min(axis=1), things.max(axis=1))
        if left is None:
            continue
        mine = {tuple(one.ravel()) for one in things[: last - first]}
        assert mine == {tuple(one.ravel()) for one in things[left]}
        checked += 1
    return checked


@pytest.mark.parametrize("count", [5, 9, 40, 150])
@pytest.mark.parametrize("seed", range(3))
def test_triangles(seed, count):
    vertices, faces = soup(np.random.default_rng([seed, count]), count)
    tree = build_bvh(vertices * [1.0, 0.5, 2.0], faces)
    assert check(tree, tree.leaves.reshape(-1, 3, 3), TRIANGLES_IN_LEAF) > 0


@pytest.mark.parametrize("axis", range(3))
def test_points_along_one_axis(axis):
    points = np.zeros((60, 3))
    points[:, axis] = np.random.default_rng(axis).normal(size=60) ** 3
    points += np.random.default_rng(9).normal(0.0, 1e-3, points.shape)
    tree = build_point_tree(points)
    assert check(tree, tree.leaves.reshape(-1, 1, 3), POINTS_IN_LEAF) > 0


def test_two_heaps_are_the_two_children_of_the_root():
    rng = np.random.default_rng(4)
    points = np.concatenate([rng.normal(0.0, 0.1, (30, 3)), rng.normal(5.0, 0.1, (20, 3))])
    tree = build_point_tree(points)
    assert ranges(tree)[0, 0] == (0, 30)
    assert ranges(tree)[0, 1] == (30, 50)


def test_things_at_one_place_are_halved():
    tree = build_point_tree(np.zeros((33, 3)))
    assert ranges(tree)[0, 0] == (0, 16)
    assert ranges(tree)[0, 1] == (16, 33)


def test_boxes_are_rounded_outward_by_no_more_than_one_step():
    points = np.random.default_rng(5).normal(size=(40, 3)) * [1e-3, 1.0, 1e4]
    tree = build_point_tree(points)
    for (node, child), (first, last) in ranges(tree).items():
        low, high = tree.boxes[node, 6 * child : 6 * child + 6].reshape(2, 3)
        inside = tree.leaves[first:last]
        assert (low <= inside.min(axis=0)).all()
        assert (np.nextafter(low, np.float32(np.inf)) > inside.min(axis=0)).all()
        assert (high >= inside.max(axis=0)).all()
        assert (np.nextafter(high, np.float32(-np.inf)) < inside.max(axis=0)).all()
