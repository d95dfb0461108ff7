"""What a recording holds of a trial, from messages written down by hand."""

import pytest

from igrip import Observation
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from trial_messages import POSE, TRIAL, record


def test_detections():
    recorded = record("x.x", "x .")
    assert recorded.times == [0.0, 0.1, 0.2]
    assert recorded.hand_detected == [True, False, True]
    assert (recorded.looked, recorded.target_detected) == ([0.0, 0.2], [True, False])
    assert recorded.hand_times == [0.0, 0.2]
    assert recorded.hand_positions == [(0.0, 0.0, 0.0), (0.0, 0.02, 0.0)]
    assert recorded.objects == {"cup"}
    assert recorded.observed == 1  # without the hand, and without the cup
    assert recorded.seconds == pytest.approx(0.2)
    assert RecordedTrial(TRIAL).seconds == 0.0


def test_a_hand_has_the_time_at_which_it_was_measured():
    """A measurement that comes again, or late, is not another point of the trace."""
    recorded = RecordedTrial(TRIAL)
    for t, measured in ((1.0, 0.9), (1.1, 0.9), (1.2, 0.8), (1.3, 1.2)):
        hand = {"position": [measured, 0, 0], "t": measured}
        recorded.add(Observation(t=t, hands={"right": hand, "left": {"position": [9, 9, 9]}}))
    assert recorded.hand_times == [0.9, 1.2]
    assert recorded.hand_positions == [(0.9, 0.0, 0.0), (1.2, 0.0, 0.0)]
    assert recorded.hand_detected == [True] * 4


def test_without_a_task_nothing_is_looked_for():
    recorded = RecordedTrial(Trial("r"))
    recorded.add(Observation(t=0.0, hands={"right": {"position": [0, 0, 0]}}, objects={"a": POSE}))
    recorded.add(Observation(t=0.1, objects={"a": None, "b": None}))
    assert recorded.hand_detected == [False, False]
    assert (recorded.looked, recorded.objects, recorded.observed) == ([], {"a"}, 0)


def test_onset_and_end_of_the_raw_trace_where_the_table_has_none():
    trial = Trial("r", hand="right", target="cup")
    recorded, table = RecordedTrial(trial), RecordedTrial(TRIAL)
    for k in range(90):
        s = min(max((k / 30 - 1.0) / 1.0, 0.0), 1.0)
        y = 0.4 * s**3 * (10 - 15 * s + 6 * s * s)
        for one in (recorded, table):
            one.add(Observation(t=k / 30, hands={"right": {"position": [0, y, 0]}}))
    onset, end = recorded.bounds()
    assert onset == pytest.approx(1.08, abs=0.07)
    assert end == pytest.approx(1.92, abs=0.1)
    assert table.bounds() == (0.2, 1.0)
    half = RecordedTrial(Trial("r", hand="right", target="cup", onset_s=0.2))
    assert half.bounds() is None
    assert RecordedTrial(trial).bounds() is None


def test_a_twitch_before_the_reach_is_no_onset():
    """The hand moves at a sixth of the peak speed, rests, and then reaches: as noise does."""
    recorded = RecordedTrial(Trial("r", hand="right", target="cup"))
    for k in range(120):
        y = 0.0
        for begin, way in ((0.5, 0.05), (2.0, 0.3)):
            s = min(max(k / 30 - begin, 0.0), 1.0)
            y += way * s**3 * (10 - 15 * s + 6 * s * s)
        recorded.add(Observation(t=k / 30, hands={"right": {"position": [0, y, 0]}}))
    onset, end = recorded.bounds()
    assert onset == pytest.approx(2.08, abs=0.07)
    assert end == pytest.approx(2.92, abs=0.1)


def looks(text, end, silent_from=None, step=0.1):
    recorded = RecordedTrial(TRIAL)
    for k, c in enumerate(text):
        objects = {} if c == " " else {"cup": POSE if c == "x" else None}
        recorded.add(Observation(t=k * step, objects=objects))
    return recorded.target_looks(0.0, end)


def test_looks_are_those_in_the_messages():
    times, detected = looks("x x . x", end=0.7)
    assert times == pytest.approx([0.0, 0.2, 0.4, 0.6])
    assert detected == [True, True, False, True]


def test_a_silent_source_misses_at_its_usual_rate_but_not_for_ever():
    times, detected = looks("xxxx" + " " * 3 + "xxx", end=0.9)  # 0.4 s of silence: three looks
    assert times[3:7] == pytest.approx([0.3, 0.4, 0.5, 0.6])
    assert detected == [True] * 4 + [False] * 3 + [True] * 3
    times, detected = looks("xxxx", end=60.0)
    assert times == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    assert detected == [True] * 4 + [False] * 4  # one more than may be missed


def test_a_short_silence_is_none():
    """Three usual steps, and 0.3 s whatever the rate."""
    assert len(looks("xxxx" + " " * 2 + "xx", end=0.7)[0]) == 6  # 0.3 s
    assert len(looks("xxxx" + " " * 14 + "xx", end=0.38, step=0.02)[0]) == 6  # 15 steps, 0.3 s
    assert len(looks("xxxx" + " " * 2 + "xx", end=3.5, step=0.5)[0]) == 6  # three steps, 1.5 s


def test_a_target_reported_once_for_good_needs_no_second_look():
    recorded = record("xxxxx", "x    ")
    assert recorded.target_looks(0.0, 0.4) == ([0.0, 0.1, 0.2], [True] * 3)
    assert record("xxxxx", ".    ").target_looks(0.0, 0.4) == ([0.0], [False])
    assert record("xxxxx", "     ").target_looks(0.0, 0.4) == ([], [])


def test_messages_of_two_cameras_at_one_time():
    """The usual step between looks is that between different times."""
    recorded = RecordedTrial(TRIAL)
    for t in (0.0, 0.0, 0.1, 0.1, 0.2, 0.2, 1.0, 1.0):
        recorded.add(Observation(t=t, objects={"cup": POSE}))
    times, detected = recorded.target_looks(0.0, 1.0)
    assert times == pytest.approx([0.0, 0.0, 0.1, 0.1, 0.2, 0.2, 0.3, 0.4, 0.5, 0.6, 1.0, 1.0])
    assert detected == [True] * 6 + [False] * 4 + [True] * 2
    once = RecordedTrial(TRIAL)
    for _ in range(2):
        once.add(Observation(t=1.0, objects={"cup": POSE}))
    assert once.target_looks(0.0, 2.0) == ([1.0, 1.0], [True, True])


@pytest.mark.parametrize(
    ("times", "missing"),
    [
        ((0.0, 1.0), None),
        ((0.2, 0.9), None),  # a tenth of a second may be missing at the end
        ((0.2, 0.89), "the recording ends before the movement does"),
        ((0.21, 1.0), "the recording begins after the movement does"),
        ((), "the recording ends before the movement does"),
    ],
)
def test_missing_part(times, missing):
    recorded = RecordedTrial(TRIAL)
    for t in times:
        recorded.add(Observation(t=t))
    assert recorded.missing_part((0.2, 1.0)) == missing
