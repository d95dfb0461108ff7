"""Whether a detection was good enough: trials of a few frames, counted by hand."""

import numpy as np
import pytest

from igrip.lab.evaluation.validity import assess_detection


def assess(text, begin=0.0, end=None):
    """Assess frames at 10 Hz: x detected, . missed."""
    times = np.arange(len(text)) / 10
    end = (len(text) - 1) / 10 if end is None else end
    return assess_detection(times, [c == "x" for c in text], begin, end)


@pytest.mark.parametrize(
    ("text", "found", "gap", "problem"),
    [
        ("xxxxxxxxxx", 0.0, 0, None),
        ("..xxxxxxxx", 0.2, 0, None),
        ("xx.xxxxxxx", 0.3, 0, None),  # the first run of three, not the first detection
        ("xxx...xxxx", 0.0, 3, None),  # three in a row may be missed
        ("xxx....xxx", 0.0, 4, "missed in more than 3 frames in a row"),
        ("xxxxxx....", 0.0, 4, "missed in more than 3 frames in a row"),  # up to the end
        ("x.x.x.x.x.", None, 0, "never found"),
        ("..........", None, 0, "never found"),
        ("", None, 0, "never found"),
        ("xx", None, 0, "never found"),
        (".......xxx", 0.7, 0, "found too late"),  # 0.2 s of 0.9 s remain
        ("....xxxxxx", 0.4, 0, None),  # 0.5 s is not more than 0.5 s, but more than half of 0.9 s
        (".....xxxxx", 0.5, 0, "found too late"),
    ],
)
def test_by_hand(text, found, gap, problem):
    quality = assess(text)
    assert quality.found == (None if found is None else pytest.approx(found))
    assert quality.max_gap == gap
    assert quality.problem == problem


def test_only_the_trial_counts():
    assert assess("xxxxxx....", end=0.6).problem is None
    assert assess("...xxx....", begin=0.3, end=0.6).found == pytest.approx(0.3)
