"""A candidate turned about its line."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.grasps.candidate import Candidate, turn_about

X, Y, Z = np.eye(3)
SIDE = Candidate(
    "palmar", "body", 0.01 * Z, -X, Y, 0.06, 0.03, 1.0, np.zeros(3), Z, (-np.pi, np.pi)
)
ANGLES = st.floats(-3.0, 3.0)


@given(ANGLES, ANGLES)
def test_turns_add_up(a, b):
    once, twice = SIDE.turned(a + b), SIDE.turned(a).turned(b)
    for name in ("point", "approach", "closing"):
        assert getattr(once, name) == pytest.approx(getattr(twice, name), abs=1e-12)
    assert turn_about(Z, a) == pytest.approx(Rotation.from_rotvec(a * Z).as_matrix())


@given(ANGLES)
def test_it_turns_to_the_side_of_the_hand(angle):
    hand = 0.4 * np.array([np.cos(angle), np.sin(angle), 0.2])
    turned = SIDE.turned(SIDE.turn_to(hand))
    assert turned.approach[:2] == pytest.approx(-hand[:2] / 0.4, abs=1e-9)


def test_it_turns_no_further_than_it_may():
    some = SIDE._replace(turns=(-0.5, 0.25))
    assert some.turn_to(Y) == pytest.approx(0.25)
    assert some.turn_to(-Y) == pytest.approx(-0.5)
    assert SIDE._replace(turns=(0.0, 0.0)).turn_to(Y) == 0.0


def test_a_palm_on_the_line_turns_by_its_closing_direction_either_way():
    top = SIDE._replace(approach=-Z, closing=X, turns=(-np.pi, np.pi))
    assert top.turn_to(Y) == 0.0
    assert abs(top.turned(top.turn_to(Y, closing=Y)).closing @ Y) == pytest.approx(1.0)
    assert abs(top.turn_to(Y, closing=-X)) == pytest.approx(0.0, abs=1e-9)


def test_contacts_and_palm():
    assert SIDE.contacts == pytest.approx(np.array([[0, -0.03, 0.01], [0, 0.03, 0.01]]))
    assert SIDE.palm(0.06) == pytest.approx([0.09, 0.0, 0.01])
