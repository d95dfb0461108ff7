"""Ids of hands in other spellings."""

from __future__ import annotations

import pytest

from igrip.io.hand_ids import is_hand, match_hand, side_of


@pytest.mark.parametrize("id", [
    "right", "Right", "RIGHT", "R", "r", "RH", "right_hand", "hand_right", "RightHand", "rightHand",
    "hand-R", "Right Palm", "R_wrist", "hand.right",
])  # fmt: skip
def test_spellings_of_the_right_hand(id):
    assert side_of(id) == "right"
    assert match_hand(id, ["left", "right"]) == "right"
    assert is_hand(id)


@pytest.mark.parametrize("id", ["hand_0", "hand", "bright", "mug", "right_left", "", "0", "mirror"])
def test_what_shows_no_side_is_not_matched(id):
    assert side_of(id) is None
    assert match_hand(id, ["left", "right"]) is None
    assert is_hand(id) == ("hand" in id)


def test_an_exact_id_comes_first_and_doubt_matches_nothing():
    assert match_hand("R", ["R", "right"]) == "R"
    assert match_hand("Right", ["R", "right_hand"]) is None
    assert match_hand("HAND_0", ["hand_0"]) == "hand_0"
