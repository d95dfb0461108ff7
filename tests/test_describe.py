import doctest

import pytest

import igrip.describe
from igrip import Intention
from igrip.describe import describe


def test_examples() -> None:
    assert doctest.testmod(igrip.describe).attempted == 2
    assert doctest.testmod(igrip.describe).failed == 0


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"status": "lost", "reason": "not measured for 0.40 s"},
         "left hand is lost: not measured for 0.40 s"),
        ({"status": "idle"}, "left hand rests"),
        ({"status": "idle", "target": "soup", "grip": "pinch"},
         "left hand rests"),
        ({"status": "reaching", "target": "soup", "grip": "pinch", "confidence": 0.5,
          "probability": {"soup": 0.7, "none": 0.3}},
         "left hand reaches for soup, pinch grip, 70% sure"),
        ({"status": "reaching", "target": "soup", "grip": "pinch", "confidence": 0.02,
          "probability": {"soup": 0.02, "none": 0.97}},
         "left hand moves, undecided: none 97%, soup 2%"),
        ({"status": "reaching", "target": "soup", "grip": "pinch", "confidence": 0.4,
          "probability": {"soup": 0.4, "none": 0.4, "mustard": 0.2}},
         "left hand moves, undecided: none 40%, soup 40%"),
        ({"status": "reaching"}, "left hand moves, undecided"),
        ({"status": "holding", "target": "soup", "grip": "pinch"}, "left hand holds an object"),
    ],
)  # fmt: skip
def test_words(fields: dict[str, object], words: str) -> None:
    assert describe(Intention(t=1.0, hand="left", **fields)) == words
