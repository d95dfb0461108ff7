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
    ("text", "found", "problem"),
    [
        ("xxxxxxxxxx", 0.0, None),
        ("..xxxxxxxx", 0.2, None),
        ("xx.xxxxxxx", 0.3, None),  # the first run of three, not the first detection
        ("xxx...xxxx", 0.0, None),  # three in a row may be missed
        ("xxx....xxx", 0.0, "missed in more than 3 frames in a row"),
        ("xxxxxx....", 0.0, "missed in more than 3 frames in a row"),  # up to the end
        ("x.x.x.x.x.", None, "never found"),
        ("..........", None, "never found"),
        ("", None, "never found"),
        ("xx", None, "never found"),
        (".......xxx", 0.7, "found too late"),  # 0.2 s of 0.9 s remain
        ("....xxxxxx", 0.4, None),  # 0.5 s is not more than 0.5 s, but more than half of 0.9 s
        (".....xxxxx", 0.5, "found too late"),
        ("....xxxxx", 0.4, "found too late"),  # half of 0.8 s is not more than half
        ("." * 15 + "x" * 6, 1.5, "found too late"),  # 0.5 s is not more than 0.5 s
        ("." * 14 + "x" * 7, 1.4, None),
    ],
)
def test_by_hand(text, found, problem):
    detection = assess(text)
    assert detection.found == (None if found is None else pytest.approx(found))
    assert detection.problem == problem


def test_only_the_trial_counts():
    assert assess("xxxxxx....", end=0.6).problem is None
    assert assess("...xxx....", begin=0.3, end=0.6).found == pytest.approx(0.3)
    assert assess("xxxxx...xxx", begin=0.6).problem == "found too late"  # 0.2 s of 0.4 s remain
