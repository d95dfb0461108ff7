"""Was it seen well enough? Trials of a few frames, counted by hand."""

import numpy as np
import pytest

from igrip.lab.evaluation.validity import longest_row, sight


def seen(text, begin=0.0, end=None):
    """Judge a row of frames at 10 Hz: x seen, . missed."""
    times = np.arange(len(text)) / 10
    flags = np.array([c == "x" for c in text], dtype=bool)
    return sight(times, flags, begin, (len(text) - 1) / 10 if end is None else end)


@pytest.mark.parametrize(
    ("text", "found", "gap", "reason"),
    [
        ("xxxxxxxxxx", 0.0, 0, None),
        ("..xxxxxxxx", 0.2, 0, None),
        ("xx.xxxxxxx", 0.3, 0, None),  # the first run of three, not the first sight
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
def test_by_hand(text, found, gap, reason):
    told = seen(text)
    assert told.found == (None if found is None else pytest.approx(found))
    assert told.max_gap == gap
    assert told.reason == reason


def test_only_the_trial_counts():
    assert seen("xxxxxx....", end=0.6).reason is None
    assert seen("...xxx....", begin=0.3, end=0.6).found == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("text", "length"), [("", 0), (".", 0), ("x", 1), ("xx.xxx.x", 3), ("..xxxx", 4), ("xx.xx", 2)]
)
def test_longest_row(text, length):
    assert longest_row(np.array([c == "x" for c in text], dtype=bool)) == length
