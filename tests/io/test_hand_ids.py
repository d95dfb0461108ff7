"""Hand ids in other spellings."""

import pytest

from igrip.io.hand_ids import is_hand, match_hand, side_of

RIGHT = [
    "right", "Right", "RIGHT", "R", "r", "right_hand", "Right Hand", "RightHand", "rightHand",
    "hand_right", "hand-R", "hand.right", "hand.R", "rh", "RWrist", "rWrist", "R_wrist",
    "right-palm", "R_INDEX", "righthand2", "RFIN", "Rechts", "Hand rechts",
    "main droite", "mano derecha",
]  # fmt: skip
NO_SIDE = ["mug", "main", "hand", "bright", "brighter", "right_left", "left_right", "LR", "0",
           "mirror", "hand_0", "bottle right", ""]  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_hands(name):
    assert side_of(name) == "right"
    assert is_hand(name)
    assert match_hand(name, ["left", "right"]) == "right"


@pytest.mark.parametrize("name", NO_SIDE)
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
