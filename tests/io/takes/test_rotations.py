"""Rotations as files hold them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.io.takes.rotations import quaternions

TURNS = Rotation.random(50, rng=np.random.default_rng(0))


def same(found, expected=TURNS):
    return (Rotation.from_quat(found) * expected.inv()).magnitude().max() < 1e-7


FORMS = {
    "xyzw": TURNS.as_quat(),
    "wxyz": np.roll(TURNS.as_quat(), 1, axis=1),
    "matrix": TURNS.as_matrix().transpose(0, 2, 1).reshape(-1, 9),
    "rotvec": np.degrees(TURNS.as_rotvec()),
    "XYZ": TURNS.as_euler("XYZ", degrees=True),
    "zyx": TURNS.as_euler("zyx", degrees=True),
}


@pytest.mark.parametrize("kind", FORMS)
def test_forms(kind):
    assert same(quaternions(FORMS[kind], kind).values)


@pytest.mark.parametrize("kind", ["rotvec", "XYZ"])
def test_radians(kind):
    assert same(quaternions(np.radians(FORMS[kind]), kind, degrees=False).values)


def test_two_decimals_are_normalised_and_counted():
    found = quaternions(np.round(FORMS["xyzw"], 2), "xyzw")
    assert np.linalg.norm(found.values, axis=1) == pytest.approx(np.ones(50))
    assert 0 < found.rounded <= 50
    assert quaternions(FORMS["xyzw"], "xyzw").rounded == 0


@pytest.mark.parametrize("kind", ["xyzw", "wxyz", "matrix"])
@pytest.mark.parametrize("value", [0.0, np.nan, 2.0])
def test_what_is_no_rotation(kind, value):
    numbers = FORMS[kind].copy()
    numbers[3] = value
    found = quaternions(numbers, kind).values
    assert np.flatnonzero(np.isnan(found).any(axis=1)).tolist() == [3]


def test_a_mirror_is_no_rotation():
    numbers = FORMS["matrix"].copy()
    numbers[3, :3] *= -1
    assert np.isnan(quaternions(numbers, "matrix").values[3]).all()
