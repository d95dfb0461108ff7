import doctest

import pytest

import igrip.describe
from igrip import Intention
from igrip.describe import describe


def test_examples() -> None:
    assert doctest.testmod(igrip.describe).attempted == 1
    assert doctest.testmod(igrip.describe).failed == 0


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"status": "lost", "reason": "not measured for 0.40 s"},
         "left hand is lost: not measured for 0.40 s"),
        ({"status": "idle"}, "left hand rests, no target"),
        ({"status": "idle", "target": "soup", "grip": "pinch"},
         "left hand rests; nearest guess soup, pinch grip"),
        ({"status": "reaching", "target": "soup", "grip": "pinch", "confidence": 0.5,
          "probability": {"soup": 0.7, "none": 0.3}},
         "left hand reaches for soup, pinch grip, 70% sure"),
    ],
)  # fmt: skip
def test_words(fields: dict[str, object], words: str) -> None:
    assert describe(Intention(t=1.0, hand="left", **fields)) == words
