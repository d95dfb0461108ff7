"""One trial judged, from messages and answers written down by hand."""

import pytest

from igrip import Observation
from igrip.intention import Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.trial_metrics import Seen, describe_trial, judge

TRIAL = Trial(
    "r", participant="p", camera_side="left", hand="right", target="cup", grip="pinch",
    movement="executed", onset_s=0.2, end_s=1.0,
)  # fmt: skip
POSE = {"model": "m", "position": [0, 0.4, 0], "orientation": [0, 0, 0, 1]}


def answers(text, grips=None, trial=TRIAL):
    """Return answers at 10 Hz: c the cup, o another, - none."""
    names = {"c": "cup", "o": "other", "-": None}
    said = [
        Intention(
            t=k / 10, hand="right", status="reaching", target=names[c],
            grip=None if grips is None else {"P": "palmar", "p": "pinch", "-": None}[grips[k]],
        )
        for k, c in enumerate(text)
    ]  # fmt: skip
    return judge(trial, (0.2, 1.0), said)


def test_by_hand():
    row = answers("ooooccccccc", "PPPPPPppppp")
    assert (row["frames_possible"], row["frames_right"]) == (11, 7)
    assert row["success"]
    assert row["found_s"] == 0.4
    assert row["delay_s"] == pytest.approx(0.2)
    assert row["margin_s"] == pytest.approx(0.6)
    assert row["grip_success"]
    assert row["grip_delay_s"] == pytest.approx(0.4)
    # 20 % of 0.2-1.0 s is 0.36 s: the newest answer is that of 0.3 s
    assert [row[f"right_at_{f}%"] for f in (20, 30, 40, 100)] == [False, True, True, True]


def test_a_run_that_begins_before_onset_has_a_negative_delay_and_a_clipped_one():
    row = answers("ccccccccccc")
    assert row["delay_s"] == pytest.approx(-0.2)
    assert row["delay_clipped_s"] == 0.0


def test_frames_after_the_end_do_not_count():
    row = answers("ooooooooooo" + "c" * 20)
    assert row["frames_possible"] == 11
    assert not row["success"]
    assert row["found_s"] is None


def test_the_grip_is_that_of_the_predicted_target_whichever_it_is():
    row = answers("ooooooooooo", "ppppppppppp")
    assert row["grip_success"]
    assert not row["success"]


def test_seventy_percent_is_not_enough():
    assert answers("ooo" + "cccccc" + "oo")["ratio"] == 0.75
    assert not answers("o" + "ccccccc" + "ooo")["success"]  # 7 of 10


def test_no_answers_at_all():
    row = judge(TRIAL, (0.2, 1.0), [])
    assert (row["answers"], row["success"], row["right_at_100%"]) == (0, False, False)


def test_another_hand_does_not_count():
    said = [Intention(t=k / 10, hand="left", status="reaching", target="cup") for k in range(11)]
    assert judge(TRIAL, (0.2, 1.0), said)["answers"] == 0


def test_without_a_reach_named_targets_are_counted():
    trial = Trial("r", target="none")
    said = [
        Intention(t=k / 10, hand="right", status=status, target=target)
        for k, (status, target) in enumerate(
            [("warming_up", None), ("idle", None), ("idle", "cup"), ("reaching", "cup")]
        )
    ]
    row = judge(trial, None, said)
    assert (row["answers"], row["named"], row["reaching"], row["named_reaching"]) == (3, 2, 1, 1)


def test_calibration_sums():
    said = [
        Intention(t=0.5, hand="right", status="reaching", target="cup",
                  probability={"cup": 0.75, "other": 0.15, "none": 0.10}),
        Intention(t=0.6, hand="right", status="reaching", target="other",
                  probability={"cup": 0.25, "other": 0.65, "none": 0.10}),
        Intention(t=1.5, hand="right", status="reaching", target="other",
                  probability={"cup": 0.0, "other": 1.0, "none": 0.0}),  # after the end
    ]  # fmt: skip
    row = judge(TRIAL, (0.2, 1.0), said)
    assert row["brier_n"] == 2
    assert row["brier_sum"] == pytest.approx(
        (0.25**2 + 0.15**2 + 0.1**2) + (0.75**2 + 0.65**2 + 0.1**2)
    )
    assert row["calibration_n"][7] == row["calibration_n"][6] == 1
    assert sum(row["calibration_right"]) == 1.0


def messages(hand, cup):
    seen = Seen("right", "cup")
    for k, (h, c) in enumerate(zip(hand, cup, strict=True)):
        hands = {"right": {"position": [0, 0.01 * k, 0]} if h == "x" else None}
        objects = {} if c == " " else {"cup": POSE if c == "x" else None}
        seen.take(Observation(t=k / 10, hands=hands, objects=objects))
    return seen


def test_what_a_trial_was():
    row = describe_trial(TRIAL, messages("xxxxx.xxxxx", "x xx x x x."), (0.2, 1.0), [])
    assert row["valid"]
    assert row["view"] == "contra"
    assert row["observed"] == pytest.approx(9 / 11)  # without the hand, and without the cup
    assert row["movement_s"] == pytest.approx(0.8)
    assert row["both_seen_0.3s_before_end"]


def test_a_target_that_is_lost_makes_it_invalid():
    row = describe_trial(TRIAL, messages("xxxxxxxxxxx", "xxxx....xxx"), (0.2, 1.0), [])
    assert not row["valid"]
    assert row["invalid_reason"] == "target missed in more than 3 frames in a row"


def test_a_target_told_once_for_good_is_seen():
    row = describe_trial(TRIAL, messages("xxxxxxxxxxx", "x          "), (0.2, 1.0), [])
    assert row["valid"]


def test_onset_and_end_of_the_raw_trace_where_the_table_has_none():
    seen = Seen("right", "cup")
    for k in range(90):
        s = min(max((k / 30 - 1.0) / 1.0, 0.0), 1.0)
        y = 0.4 * s**3 * (10 - 15 * s + 6 * s * s)
        seen.take(Observation(t=k / 30, hands={"right": {"position": [0, y, 0]}}))
    onset, end = seen.bounds(Trial("r", hand="right", target="cup"))
    assert onset == pytest.approx(1.08, abs=0.07)
    assert end == pytest.approx(1.92, abs=0.1)
    assert seen.bounds(TRIAL) == (0.2, 1.0)


def test_what_was_not_recorded_cannot_be_right():
    """The recording stops in the middle of the movement, all answers right until then."""
    said = [Intention(t=k / 10, hand="right", status="reaching", target="cup") for k in range(7)]
    row = judge(TRIAL, (0.2, 1.0), said, last=0.6)
    assert not row["success"]
    assert row["right_at_50%"]
    assert not row["right_at_85%"]
    assert not row["right_at_100%"]
    told = describe_trial(TRIAL, messages("xxxxxxx", "x xx x "), (0.2, 1.0), [])
    assert told["invalid_reason"] == "the recording ends before the movement does"


def test_a_target_that_goes_silent_is_missed():
    seen = messages("x" * 31, "x x x x x x" + " " * 20)
    row = describe_trial(TRIAL, seen, (0.2, 3.0), [])
    assert row["invalid_reason"] == "target missed in more than 3 frames in a row"


def test_a_camera_that_is_neither_left_nor_right_has_no_view():
    trial = Trial("r", camera_side="front", hand="right", target="cup", onset_s=0.2, end_s=1.0)
    seen = messages("xxxxxxxxxxx", "x xx x x x ")
    assert describe_trial(trial, seen, (0.2, 1.0), [])["view"] is None


def test_without_a_grip_no_grip_is_counted():
    trial = Trial("r", hand="right", target="cup", onset_s=0.2, end_s=1.0)
    row = answers("ccccccccccc", "ppppppppppp", trial)
    assert not [key for key in row if key.startswith("grip")]
