"""Points, vectors and distances in the frame of a mesh, against scipy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.geometry.object_frame import distance, distance2, to_mesh, turn_to_mesh
from support import random_turn


@given(st.integers(0, 10_000))
def test_points_and_vectors_in_the_frame_of_a_mesh(seed):
    rng = np.random.default_rng(seed)
    turn, shift, p, out = random_turn(rng), rng.normal(size=3), rng.normal(size=3), np.empty(3)
    to_mesh(turn.as_matrix(), shift, p, out)
    assert out == pytest.approx(turn.inv().apply(p - shift), abs=1e-12)
    turn_to_mesh(turn.as_matrix(), p, out)
    assert out == pytest.approx(turn.inv().apply(p), abs=1e-12)


@given(st.integers(0, 10_000))
def test_distances(seed):
    p, q = np.random.default_rng(seed).normal(size=(2, 3))
    expected = math.dist(p, q)
    assert distance(p, q) == pytest.approx(expected, rel=1e-14)
    assert distance2(p, *q) == pytest.approx(expected**2, rel=1e-11)
    assert distance2(p, *q) > expected**2  # with room for rounding: it bounds a search


def test_a_distance_of_zero_still_leaves_room():
    p = np.array([0.1, -0.2, 0.3])
    assert distance(p, p) == 0.0
    assert 0.0 < distance2(p, *p) < 1e-200
