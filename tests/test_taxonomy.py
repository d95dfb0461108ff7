"""The taxonomy of grips, and what stands in for what."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.taxonomy import GRIP_TYPES, NAMES, PAPER_GRIP, paper_grip, stand_in


def test_the_papers_grips_keep_their_names():
    assert set(PAPER_GRIP.values()) == {"palmar", "pinch"}
    assert paper_grip("palmar") == "palmar"
    assert paper_grip("pinch") == "pinch"
    assert paper_grip("hook") == "palmar"
    assert paper_grip("tripod") == "pinch"


@pytest.mark.parametrize("name", NAMES)
def test_every_order_is_of_known_grips_and_ends_with_the_papers(name):
    order = GRIP_TYPES[name].nearest
    assert set(order) <= set(NAMES) - {name}
    assert len(set(order)) == len(order)
    assert {name, *order} & {"palmar"}
    assert {name, *order} & {"pinch"}
    assert all(1 <= number <= 33 for number in GRIP_TYPES[name].feix)  # of the GRASP taxonomy


@given(st.sampled_from(NAMES), st.sets(st.sampled_from(NAMES)))
def test_a_grip_that_can_be_done_is_done(grip, able):
    told = stand_in(grip, able)
    assert told == grip if grip in able else told is None or told in able
    if able & {"palmar", "pinch"}:
        assert told is not None


def test_a_declared_order_comes_first_and_the_unknown_has_none():
    assert stand_in("hook", ("palmar", "lateral"), order=("lateral",)) == "lateral"
    assert stand_in("my own", ("palmar",)) is None
    assert stand_in("my own", ("my own",)) == "my own"
