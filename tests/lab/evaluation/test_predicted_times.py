"""Times of contact that can be solved for, and predictions whose errors are known."""

import numpy as np
import pytest
from scipy.optimize import brentq

from igrip import Config, Intention, Observation, load_objects
from igrip.geometry.scene import PlacedObject
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.predicted_times import (
    CONTACT_DISTANCE,
    PARTS,
    contact_time,
    score_times,
    summarise_times,
    surface_distances,
)
from igrip.lab.evaluation.recorded_trial import RecordedTrial

BOX = "box:0.06x0.08x0.1"
BOUNDS = (1.0, 2.0)
FRONT = 0.46  # y of the front of the box [m]
EVENTS = ("contact", "end")


def path(t, goal=0.4):
    """Return y of a minimum-jerk reach from 0, from 1 s to 2 s."""
    s = np.clip(np.asarray(t) - 1.0, 0.0, 1.0)
    return goal * (10 * s**3 - 15 * s**4 + 6 * s**5)


def recorded(y, rate=30.0, noise=0.0, front=lambda t: FRONT):
    """Return a recording of a hand on the y axis, and of a box before which it comes."""
    catalog = load_objects(BOX)
    record = RecordedTrial(Trial("r", hand="right", target="box"))
    random = np.random.default_rng(7)
    for t in np.arange(int(2.6 * rate)) / rate:
        palm = np.array([0.0, y(t), 0.0]) + random.normal(0.0, noise, 3)
        record.add(Observation(t=t, hands={"right": {"position": palm.tolist()}}))
        place = np.array([0.0, front(t) + 0.04, 0.0])
        record.place_target(t, [placed(catalog[BOX], place)])
    return record


def placed(model, place):
    return PlacedObject("box", model, np.eye(3), place, place, np.zeros(3))


def solved(y, front=lambda t: FRONT):
    """Return when the front is 8 cm ahead of the hand."""
    return brentq(lambda t: front(t) - y(t) - 0.08, 1.0, 2.2)


def test_distances_to_a_box():
    model = load_objects(BOX)[BOX]
    points = np.array([[0.1, 0.0, 0.0], [0.0, -0.3, 0.0], [0.06, 0.08, 0.0], [0.0, 0.0, 0.04]])
    expected = [0.07, 0.26, np.hypot(0.03, 0.04), 0.01]  # the last one is within
    assert surface_distances(model, points) == pytest.approx(expected)


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_the_time_of_contact_is_where_the_path_crosses_8_cm(rate):
    assert contact_time(recorded(path, rate), BOUNDS) == pytest.approx(solved(path), abs=0.004)


def test_noise_does_not_bring_it_forward():
    errors = [contact_time(recorded(path, noise=0.004), BOUNDS) - solved(path)]
    assert np.abs(errors).max() < 0.03


def test_a_target_that_moves_is_where_it_is_at_that_moment():
    def comes(t):
        return FRONT - 0.1 * (t - 1.0)

    record = recorded(path, front=comes)
    assert len(record.target_poses) == len(record.times)
    assert contact_time(record, BOUNDS) == pytest.approx(solved(path, comes), abs=0.02)
    assert solved(path, comes) < solved(path) - 0.05


def test_a_target_that_stands_is_noted_once():
    assert len(recorded(path).target_poses) == 1


@pytest.mark.parametrize(
    ("goal", "offset"),
    [
        (0.3, 0.0),  # it never comes near
        (0.05, 0.39),  # it begins there
    ],
)
def test_no_time_of_contact(goal, offset):
    assert contact_time(recorded(lambda t: offset + path(t, goal)), BOUNDS) is None


def test_without_a_target_or_a_hand_there_is_none():
    record = recorded(path)
    record.target_poses.clear()
    assert contact_time(record, BOUNDS) is None
    assert contact_time(RecordedTrial(record.trial), BOUNDS) is None


def answer(t, contact=None, end=None, target="box", hand="right", half=0.1):
    """Return an answer that predicts two moments, with intervals of ± half a width [s]."""
    times = {}
    for event, moment in (("contact", contact), ("end", end)):
        if moment is not None:
            until = moment - t
            times[f"time_to_{event}"] = until
            times[f"time_to_{event}_interval"] = (until - half, until + half)
    return Intention(t=t, hand=hand, status="reaching", target=target, **times)


def scored(intentions, contact=1.7, last=3.0):
    return score_times("right", "box", BOUNDS, contact, intentions, last)


def test_errors_are_those_of_the_newest_answers():
    row = scored([
        answer(1.0, 9.0, 9.0), answer(1.35, 1.78, 2.3), answer(1.39, 9.0, 9.0, hand="left"),
        answer(1.55, 1.65, 1.95), answer(1.6, 1.72, 2.05), answer(1.79, 1.6, 2.2),
    ])  # fmt: skip
    assert row["contact_s"] == 1.7
    assert row["contact_error_at_40%"] == pytest.approx(0.08)
    assert row["end_error_at_40%"] == pytest.approx(0.3)
    assert row["contact_error_at_60%"] == pytest.approx(0.02)  # that of 1.6 s counts
    assert row["end_error_at_60%"] == pytest.approx(0.05)
    assert [row[f"contact_held_at_{part:.0%}"] for part in PARTS] == [True, True, None]
    assert [row[f"end_held_at_{part:.0%}"] for part in PARTS] == [False, True, False]
    assert row["contact_asked_at_80%"] is False  # the hand is there already
    assert row["contact_error_at_80%"] is None
    assert row["end_error_at_80%"] == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("intentions", "contact", "last"),
    [
        ([], 1.7, 3.0),
        ([answer(1.3, 1.7, 2.0, target="can")], 1.7, 3.0),
        ([answer(1.3, 1.7, 2.0, hand="left")], 1.7, 3.0),
        ([answer(1.45, 1.7, 2.0)], 1.7, 3.0),  # after 40 %
        ([answer(1.3, 1.7, 2.0)], 1.7, 1.25),  # not recorded until there
    ],
)
def test_where_the_target_is_not_right_nothing_is_asked(intentions, contact, last):
    row = scored(intentions, contact, last)
    for event in EVENTS:
        assert row[f"{event}_asked_at_40%"] is False
        assert row[f"{event}_error_at_40%"] is row[f"{event}_held_at_40%"] is None


def test_no_contact_no_error_of_it():
    row = scored([answer(1.3, 1.7, 2.0)], contact=None)
    assert (row["contact_asked_at_40%"], row["end_asked_at_40%"]) == (False, True)


def test_asked_and_not_answered():
    row = scored([answer(1.3)])
    for event in EVENTS:
        assert row[f"{event}_asked_at_40%"] is True
        assert row[f"{event}_error_at_40%"] is None


def test_summary_of_known_errors():
    """Errors of 0, 10 … 100 ms in turn too late and too early; half-widths of 55 ms hold six."""
    rows = [
        scored([answer(1.3, 1.7 + sign * k / 100, half=0.055)])
        for k, sign in zip(range(11), [1, -1] * 6, strict=False)
    ]
    rows += [scored([answer(1.3)]), scored([answer(1.3, 9.0, target="can")])]
    columns = {key: [row[key] for row in rows] for key in rows[0]}
    times = summarise_times(columns)
    assert set(times) == set(EVENTS)
    contact = times["contact"]["40%"]
    assert contact["asked"] == 12
    assert contact["given"] == pytest.approx(11 / 12)
    assert contact["median_s"] == pytest.approx(0.05)
    assert contact["p90_s"] == pytest.approx(0.09)
    assert contact["bias_s"] == pytest.approx(0.0)
    assert contact["held"] == pytest.approx(6 / 11)
    assert times["end"]["40%"] == {"asked": 12, "given": 0.0}
    assert "80%" not in times["contact"]  # the contact was before
    assert summarise_times({"success": [True]}) == {event: {} for event in EVENTS}


def test_the_distance_is_that_of_the_predictions():
    """What is judged is what is predicted: the same 8 cm as the default of the search."""
    assert CONTACT_DISTANCE == Config().rays.contact_distance == 0.08
