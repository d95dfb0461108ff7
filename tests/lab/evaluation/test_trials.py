"""Hand-made trials whose scores can be counted on paper."""

import numpy as np
import pytest

from igrip.lab.evaluation.trials import (
    assess_detection,
    causal_accuracy,
    longest_run,
    score_trial,
)


def flags(text: str) -> np.ndarray:
    return np.array([c == "x" for c in text])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", (0, 0)),
        ("....", (0, 0)),
        ("x", (0, 1)),
        ("..x.xx", (4, 2)),
        ("xx..xx", (0, 2)),  # tied: the earliest
        ("x.xxx.xxx", (2, 3)),
        ("....x", (4, 1)),
    ],
)
def test_longest_run(text: str, expected: tuple[int, int]) -> None:
    assert longest_run(flags(text)) == expected


def test_success_counts_from_k_target_to_k_f() -> None:
    # ten frames, one a tenth of a second; the longest run begins at frame 3
    times = np.arange(10) / 10
    score = score_trial(times, flags("..x.xxx.xx"), onset=0.1, end=0.9)
    assert score.found == pytest.approx(0.4)
    assert score.ratio == pytest.approx(5 / 6)
    assert score.success
    assert score.delay == pytest.approx(0.3)
    assert score.margin == pytest.approx(0.5)


def test_exactly_seventy_percent_is_no_success() -> None:
    times = np.arange(10) / 10
    correct = flags("xxxx.x.x.x")
    score = score_trial(times, correct, onset=0.0, end=0.9)
    assert score.ratio == pytest.approx(0.7)
    assert not score.success


def test_frames_after_the_end_do_not_count() -> None:
    times = np.arange(10) / 10
    score = score_trial(times, flags("....xxxxxx"), onset=0.0, end=0.5)
    assert (score.found, score.ratio) == (pytest.approx(0.4), pytest.approx(1.0))
    assert score.margin == pytest.approx(0.1)


def test_a_run_may_begin_before_onset() -> None:
    score = score_trial(np.arange(4) / 10, flags("xxxx"), onset=0.2, end=0.3)
    assert score.delay == pytest.approx(-0.2)


def test_a_run_at_the_last_frame_succeeds() -> None:
    score = score_trial(np.arange(3) / 10, flags("..x"), onset=0.0, end=0.2)
    assert score.success
    assert score.margin == pytest.approx(0.0)


@pytest.mark.parametrize("text", ["", "...."])
def test_never_right_is_no_success(text: str) -> None:
    score = score_trial(np.arange(len(text)) / 10, flags(text), onset=0.0, end=1.0)
    assert score == (False, 0.0, None, None, None)


def test_causal_accuracy_takes_the_newest_answer() -> None:
    times = np.array([0.0, 0.3, 0.65, 1.0])
    right = causal_accuracy(times, flags(".x.x"), 0.0, 1.0, (0.2, 0.3, 0.6, 0.65, 1.0))
    assert right.tolist() == [False, True, True, False, True]


def test_causal_accuracy_of_a_single_answer() -> None:
    assert causal_accuracy(np.array([0.5]), flags("x"), 0.0, 1.0, (0.6,)).tolist() == [True]


def test_causal_accuracy_before_the_first_answer_is_wrong() -> None:
    assert causal_accuracy(np.array([0.5]), flags("x"), 0.0, 1.0, (0.4,)).tolist() == [False]


def test_causal_accuracy_survives_decimal_times() -> None:
    # 0.1 + 0.2 > 0.3 in binary: the frame written as 0.3 falls on the instant all the same
    times = np.array([0.1, 0.30000000000000004])
    assert causal_accuracy(times, flags(".x"), 0.0, 1.0, (0.3,)).tolist() == [True]


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
    assert assess("xxxxx...xxxxx", begin=0.6).problem is None  # 0.4 s of 0.6 s
