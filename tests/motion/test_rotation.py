"""Quaternions against scipy, and the axioms of rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.motion import rotation

COMPONENT = st.floats(-1.0, 1.0)
QUATERNIONS = st.tuples(*[COMPONENT] * 4).filter(lambda q: math.hypot(*q) > 1e-3)
UNIT = QUATERNIONS.map(rotation.normalise)
ANGLES = st.sampled_from([0.0, 1e-12, 1e-9, 1e-5, 9.9e-5, 1.1e-4, 0.1, 1.0, 3.0, math.pi - 1e-6])
AXES = st.tuples(*[COMPONENT] * 3).filter(lambda v: math.hypot(*v) > 1e-3)


def same_rotation(a, b, tolerance=1e-12):
    return abs(abs(np.dot(a, b)) - 1.0) < tolerance


def vector(axis, angle):
    size = math.hypot(*axis)
    return tuple(angle * x / size for x in axis)


@given(QUATERNIONS)
def test_normalise(q):
    unit = rotation.normalise(q)
    assert math.hypot(*unit) == pytest.approx(1.0, abs=1e-15)
    assert np.array(unit) * math.hypot(*q) == pytest.approx(np.array(q))


@given(UNIT, UNIT)
def test_product_and_inverse_agree_with_scipy(a, b):
    expected = (Rotation.from_quat(a) * Rotation.from_quat(b)).as_quat()
    assert same_rotation(rotation.multiply(a, b), expected)
    assert same_rotation(rotation.conjugate(a), Rotation.from_quat(a).inv().as_quat())


@given(UNIT)
def test_matrix_agrees_with_scipy_and_is_a_rotation(q):
    matrix = np.array(rotation.matrix(q))
    assert matrix == pytest.approx(Rotation.from_quat(q).as_matrix(), abs=1e-14)
    assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(matrix) == pytest.approx(1.0, abs=1e-14)


@given(AXES, ANGLES)
def test_exponential_agrees_with_scipy(axis, angle):
    v = vector(axis, angle)
    assert np.array(rotation.exponential(v)) == pytest.approx(
        Rotation.from_rotvec(v).as_quat(canonical=True), rel=1e-12, abs=1e-15
    )


@given(AXES, ANGLES)
def test_logarithm_undoes_exponential(axis, angle):
    v = vector(axis, angle)
    q = rotation.exponential(v)
    assert np.array(rotation.logarithm(q)) == pytest.approx(np.array(v), rel=1e-9, abs=1e-15)
    other = tuple(-x for x in q)  # the same rotation
    assert np.array(rotation.logarithm(other)) == pytest.approx(np.array(v), rel=1e-9, abs=1e-15)


@given(UNIT)
def test_logarithm_is_the_shortest_rotation_vector(q):
    v = rotation.logarithm(q)
    assert math.hypot(*v) <= math.pi + 1e-12
    expected = Rotation.from_quat(q)
    assert math.hypot(*v) == pytest.approx(expected.magnitude(), abs=1e-9)
    assert (Rotation.from_rotvec(v) * expected.inv()).magnitude() < 1e-9


@given(UNIT, UNIT, UNIT)
def test_group_axioms(a, b, c):
    product, inverse = rotation.multiply, rotation.conjugate
    assert same_rotation(product(product(a, b), c), product(a, product(b, c)))
    assert same_rotation(product(a, inverse(a)), rotation.IDENTITY)
    assert np.array(product(a, rotation.IDENTITY)) == pytest.approx(np.array(a))
    left = np.array(rotation.matrix(a)) @ np.array(rotation.matrix(b))
    assert np.array(rotation.matrix(product(a, b))) == pytest.approx(left, abs=1e-13)
