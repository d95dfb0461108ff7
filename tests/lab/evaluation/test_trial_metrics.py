"""How an estimator did in one trial, from answers written down by hand."""

from dataclasses import replace

import pytest

from igrip.intention import Intention
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.trial_metrics import score_answers
from trial_messages import TRIAL

BOUNDS = (0.2, 1.0)
SCORES = {"cup": {"global": 0.5}, "other": {"global": 0.4}}


def score(text, grips=None, trial=TRIAL, **more):
    """Score answers at 10 Hz: c the cup, o another, - none."""
    names = {"c": "cup", "o": "other", "-": None}
    intentions = [
        Intention(
            t=k / 10, hand="right", status="reaching", target=names[c], scores=SCORES,
            grip=None if grips is None else {"P": "palmar", "p": "pinch", "-": None}[grips[k]],
        )
        for k, c in enumerate(text)
    ]  # fmt: skip
    return score_answers(trial, BOUNDS, intentions, **more)


def test_by_hand():
    row = score("ooooccccccc", "PPPPPPppppp")
    assert row["answers"] == 11
    assert (row["frames_possible"], row["frames_right"], row["grip_frames_right"]) == (11, 7, 5)
    assert row["success"] is True
    assert row["ratio"] == 1.0
    assert row["found_s"] == 0.4
    assert row["delay_s"] == row["delay_clipped_s"] == pytest.approx(0.2)
    assert row["margin_s"] == pytest.approx(0.6)
    assert row["grip_success"] is True
    assert row["grip_found_s"] == 0.6
    assert row["grip_delay_s"] == pytest.approx(0.4)
    assert row["grip_margin_s"] == pytest.approx(0.4)
    # 20 % of 0.2-1.0 s is 0.36 s: the newest answer is that of 0.3 s
    at = [row[f"right_at_{f}%"] for f in (20, 30, 40, 50, 60, 70, 85, 100)]
    assert at == [False, True, True, True, True, True, True, True]
    assert [row[f"grip_right_at_{f}%"] for f in (40, 50, 60)] == [False, True, True]


def test_a_run_that_begins_before_onset_has_a_negative_delay_and_a_clipped_one():
    row = score("ccccccccccc")
    assert row["delay_s"] == pytest.approx(-0.2)
    assert row["delay_clipped_s"] == 0.0


def test_frames_after_the_end_do_not_count():
    row = score("ooooooooooo" + "c" * 20)
    assert (row["frames_possible"], row["frames_right"]) == (11, 0)
    assert not row["success"]
    assert (row["found_s"], row["delay_s"], row["delay_clipped_s"], row["margin_s"]) == (None,) * 4


def test_the_grip_is_that_of_the_predicted_target_whichever_it_is():
    row = score("ooooooooooo", "ppppppppppp")
    assert row["grip_success"]
    assert not row["success"]
    assert not score("ccccccccccc", "-----------")["grip_success"]


def test_seventy_percent_is_not_enough():
    assert score("ooo" + "cccccc" + "oo")["ratio"] == 0.75
    assert not score("o" + "ccccccc" + "ooo")["success"]  # 7 of 10


def test_no_answers_at_all():
    row = score("")
    assert (row["answers"], row["success"], row["right_at_100%"]) == (0, False, False)
    assert (row["frames_possible"], row["frames_right"]) == (0, 0)


def test_another_hand_does_not_count():
    left = [Intention(t=k / 10, hand="left", status="reaching", target="cup") for k in range(11)]
    assert score_answers(TRIAL, BOUNDS, left)["answers"] == 0


def answer(t, status="idle", objects=("cup",), target=None):
    scores = {id: {"global": 0.5} for id in objects}
    return Intention(t=t, hand="right", status=status, target=target, scores=scores)


def test_frames_count_from_the_first_at_which_an_answer_was_possible():
    """Not while the hand warms up, and not while no object is known that it could be."""
    answers = [
        answer(0.0, "warming_up"), answer(0.1, objects=()), answer(0.2, "reaching", objects=()),
        answer(0.3), answer(0.4, "lost"), answer(0.5, "reaching", target="cup"),
    ]  # fmt: skip
    row = score_answers(TRIAL, BOUNDS, answers)
    assert (row["frames_possible"], row["frames_right"]) == (3, 1)  # from 0.3 s on
    for status in ("idle", "reaching", "holding"):
        assert score_answers(TRIAL, BOUNDS, [answer(0.3, status)])["frames_possible"] == 1
    for status in ("warming_up", "lost", "invalid"):
        assert score_answers(TRIAL, BOUNDS, [answer(0.3, status)])["frames_possible"] == 0
    assert score_answers(TRIAL, BOUNDS, [answer(0.3, objects=())])["frames_possible"] == 0


def test_without_a_reach_named_targets_are_counted():
    trial = Trial("r", hand="right", target="none")
    likely, unlikely = {"cup": 0.2, "none": 0.8}, {"cup": 0.6, "none": 0.4}
    intentions = [
        Intention(t=k / 10, hand=hand, status=status, target=target, probability=probability)
        for k, (hand, status, target, probability) in enumerate(
            [
                ("right", "warming_up", None, None), ("right", "idle", None, likely),
                ("left", "idle", "cup", unlikely), ("right", "reaching", "cup", unlikely),
                ("right", "reaching", None, likely), ("right", "holding", "cup", None),
                ("right", "reaching", "cup", likely),
            ]
        )
    ]  # fmt: skip
    assert score_answers(trial, None, intentions) == {
        "answers": 5, "named": 3, "reaching": 3, "named_reaching": 2, "with_probability": 5,
        "none_most_probable": 3,
    }  # fmt: skip


def test_without_a_task_nothing_is_scored():
    assert score_answers(Trial("r", hand="right"), BOUNDS, [answer(0.3)]) == {}
    assert score_answers(TRIAL, None, [answer(0.3)]) == {}


def test_calibration_sums():
    intentions = [
        Intention(t=t, hand="right", status="reaching", target="cup", probability=probability)
        for t, probability in (
            (0.1, {"cup": 0.0, "other": 1.0, "none": 0.0}),  # before the onset
            (0.2, {"cup": 0.75, "other": 0.15, "none": 0.10}),
            (0.6, {"cup": 0.25, "other": 0.65, "none": 0.10}),
            (0.7, None),
            (1.0, {"other": 0.4, "none": 0.6}),  # the cup is not known
            (1.1, {"cup": 0.0, "other": 1.0, "none": 0.0}),  # after the end
        )
    ]
    row = score_answers(TRIAL, BOUNDS, intentions)
    assert row["brier_n"] == 3
    assert row["brier_sum"] == pytest.approx(
        (0.25**2 + 0.15**2 + 0.1**2) + (0.75**2 + 0.65**2 + 0.1**2) + (0.4**2 + 0.6**2 + 1.0)
    )
    assert row["calibration_n"] == [0, 0, 0, 0, 0, 0, 2, 1, 0, 0]
    assert row["calibration_stated"] == pytest.approx([0, 0, 0, 0, 0, 0, 1.25, 0.75, 0, 0])
    assert row["calibration_right"] == [0, 0, 0, 0, 0, 0, 0, 1, 0, 0]
    assert "brier_n" not in score("ccc")


def test_what_was_not_recorded_cannot_be_right():
    """The recording stops in the middle of the movement, all answers right until then."""
    row = score("ccccccc", "ppppppp", last=0.6)
    assert not row["success"]
    assert not row["grip_success"]
    assert row["right_at_50%"]
    assert row["right_at_60%"]  # 0.68 s: a tenth of a second may be missing
    assert not row["right_at_85%"]
    assert not row["right_at_100%"]
    assert not row["grip_right_at_100%"]
    assert score("cccccccccc", last=0.9)["success"]
    assert score("cccccccccc", last=0.9)["right_at_100%"]


def test_without_a_grip_no_grip_is_counted():
    row = score("ccccccccccc", "ppppppppppp", replace(TRIAL, grip=None))
    assert row["success"]
    assert not [key for key in row if key.startswith("grip")]
