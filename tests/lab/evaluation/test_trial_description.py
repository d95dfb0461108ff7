"""What a trial was: task, validity, layout of the objects, problems and remarks."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from igrip import Observation
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.evaluation.trial_description import describe_trial, find_problem, find_remarks
from trial_messages import POSE, TRIAL, record

BOUNDS = (0.2, 1.0)
WHOLE = ("xxxxxxxxxxx", "x xx x x x ")


def describe(hand, cup, bounds=BOUNDS, trial=TRIAL, objects=()):
    return describe_trial(record(hand, cup, trial), bounds, objects)


def test_what_a_trial_was():
    trial = replace(TRIAL, trial="7", camera="c", extra={"distance": "near", "more": "x"})
    assert describe("xxxxx.xxxxx", "x xx x x x.", trial=trial) == {
        "recording": "r", "participant": "p", "trial": "7", "camera": "c", "camera_side": "left",
        "hand": "right", "target": "cup", "grip": "pinch", "movement": "executed",
        "view": "contra", "group": "near", "messages": 11,
        "observed": pytest.approx(9 / 11),  # without the hand, and without the cup
        "objects": 1, "seconds": 1.0, "onset_s": 0.2, "end_s": 1.0,
        "movement_s": pytest.approx(0.8), "bounds": "table", "valid": True, "invalid_reason": None,
        "both_seen_0.3s_before_end": True, "angular_gap_deg": None, "depth_gap_m": None,
    }  # fmt: skip


def test_the_trial_begins_with_its_recording():
    """Found at 10.3 s: 0.5 s before the end, which is more than half of the 0.8 s."""
    recorded = RecordedTrial(replace(TRIAL, onset_s=10.2, end_s=10.8))
    for k in range(9):
        hands = {"right": {"position": [0, 0, 0]}} if k >= 3 else {}
        recorded.add(Observation(t=10 + k / 10, hands=hands, objects={"cup": POSE}))
    row = describe_trial(recorded, (10.2, 10.8), [])
    assert (row["valid"], row["invalid_reason"]) == (True, None)
    assert row["seconds"] == pytest.approx(0.8)
    single = RecordedTrial(TRIAL)
    single.add(Observation(t=0.0, hands={"right": {"position": [0, 0, 0]}}))
    assert describe_trial(single, None, [])["observed"] == 1.0


def test_without_a_movement_there_is_no_validity():
    row = describe_trial(RecordedTrial(TRIAL), None, [])
    assert (row["messages"], row["observed"], row["seconds"]) == (0, 0.0, 0.0)
    assert "valid" not in row


@pytest.mark.parametrize(
    ("hand", "cup", "reason"),
    [
        ("xxxxxxxxxxx", "xxxx....xxx", "target missed in more than 3 frames in a row"),
        ("xxxx....xxx", "xxxxxxxxxxx", "hand missed in more than 3 frames in a row"),
        ("xxxxxxxxxxx", ".x.x.x.x.x.", "target never found"),
        ("........xxx", "xxxxxxxxxxx", "hand found too late"),
        ("xxxxxxx", "x xx x ", "the recording ends before the movement does"),
        (
            "x.x.x.x",
            ".......",
            "the recording ends before the movement does; hand never found; target never found",
        ),
    ],
)
def test_why_a_trial_is_not_valid(hand, cup, reason):
    row = describe(hand, cup)
    assert (row["valid"], row["invalid_reason"]) == (False, reason)


def test_a_target_told_once_for_good_is_valid():
    assert describe("xxxxxxxxxxx", "x          ")["valid"]


def test_a_target_that_goes_silent_is_missed():
    row = describe("x" * 31, "x x x x x x" + " " * 20, (0.2, 3.0))
    assert row["invalid_reason"] == "target missed in more than 3 frames in a row"


@pytest.mark.parametrize(
    ("hand", "cup", "in_time"),
    [
        (".......xxxx", "xxxxxxxxxxx", True),  # 0.7 s is 0.3 s before the end
        ("........xxx", "xxxxxxxxxxx", False),
        ("xxxxxxxxxxx", "........xxx", False),
        ("x.x.x.x.x.x", "xxxxxxxxxxx", False),
    ],
)
def test_both_found_in_time(hand, cup, in_time):
    assert describe(hand, cup, (0.2, 1.0))["both_seen_0.3s_before_end"] is in_time


@pytest.mark.parametrize(
    ("side", "hand", "view"),
    [
        ("left", "left", "ipsi"), ("right", "right", "ipsi"), ("left", "right", "contra"),
        ("front", "right", None), (None, "right", None), ("left", "third", None),
        ("third", "third", None),
    ],
)  # fmt: skip
def test_view(side, hand, view):
    assert describe(*WHOLE, trial=replace(TRIAL, camera_side=side, hand=hand))["view"] == view


@pytest.mark.parametrize("missing", ["onset_s", "end_s"])
def test_bounds_of_the_trace_are_named(missing):
    assert describe(*WHOLE, trial=replace(TRIAL, **{missing: None}))["bounds"] == "trace"


def test_gaps_between_the_target_and_its_neighbour():
    """The hand is at y = 0 and 0.02 m until the onset of 0.2 s; the next one does not count."""

    def gaps(bounds=BOUNDS, **centres):
        objects = [SimpleNamespace(id=id, centre=np.array(at)) for id, at in centres.items()]
        row = describe(*WHOLE, bounds=bounds, objects=objects)
        return row["angular_gap_deg"], row["depth_gap_m"]

    cup = [0.0, 0.41, 0.0]  # 0.4 m from the mean of 0, 0.01 and 0.02 m
    near, far = [0.3, 0.31, 0.0], [0.0, -0.19, 0.0]  # at 45 degrees, and behind
    assert gaps(cup=cup, far=far, near=near) == pytest.approx((45.0, 0.3 * 2**0.5 - 0.4))
    assert gaps(cup=cup, far=far) == pytest.approx((180.0, -0.2))
    assert gaps(cup=cup) == gaps(near=near) == (None, None)
    start = gaps((-1.0, 1.0), cup=cup, behind=[0.0, -0.1, 0.0])  # nothing before: the first point
    assert start == pytest.approx((180.0, 0.1 - 0.41))
    assert gaps(cup=cup, same=cup) == pytest.approx((0.0, 0.0), abs=1e-5)
    assert (
        describe(".......", "x xx x ", objects=[SimpleNamespace(id="cup", centre=np.ones(3))])[
            "depth_gap_m"
        ]
        is None
    )


@pytest.mark.parametrize(
    ("changes", "bounds", "problem"),
    [
        ({}, BOUNDS, None),
        ({"performed": "no"}, BOUNDS, "was not performed"),
        ({"performed": "yes"}, BOUNDS, None),
        ({"target": None}, BOUNDS, "its target is not known"),
        ({"target": "none", "hand": None}, None, None),
        ({"hand": None}, BOUNDS, "its hand is not known"),
        ({}, None, "its movement has no onset and end"),
    ],
)
def test_problems(changes, bounds, problem):
    assert find_problem(record(*WHOLE, replace(TRIAL, **changes)), bounds) == problem


def test_an_empty_recording_is_a_problem():
    assert find_problem(RecordedTrial(TRIAL), BOUNDS) == "the recording is empty"
    assert find_problem(RecordedTrial(Trial("r", target="none")), None) == "the recording is empty"


@pytest.mark.parametrize(
    ("changes", "remarks"),
    [
        ({}, []),
        ({"onset_s": None}, ["its onset or its end is missing, so both are those of the trace"]),
        ({"end_s": None}, ["its onset or its end is missing, so both are those of the trace"]),
        ({"onset_s": None, "end_s": None}, []),
        ({"camera_side": None}, []),
        ({"camera_side": "top"}, ["camera_side 'top' is neither left nor right"]),
        ({"hand": "third"}, ["hand 'third' was never seen"]),
        ({"target": "mug"}, ["target 'mug' never appears"]),
        ({"target": "none", "hand": "third", "camera_side": "top"}, []),
        ({"target": None, "hand": "third"}, []),
    ],
)
def test_remarks(changes, remarks):
    assert find_remarks(record(*WHOLE, replace(TRIAL, **changes)), BOUNDS) == remarks


def test_a_recording_that_ends_early_is_remarked():
    recorded = record("xxx", "xxx")
    assert find_remarks(recorded, BOUNDS) == ["the recording ends before the movement does"]
    assert find_remarks(recorded, None) == []
