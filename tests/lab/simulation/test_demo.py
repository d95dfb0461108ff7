"""The simulated person of the demo."""

from itertools import islice

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip import Estimator, load_objects
from igrip.lab.simulation.demo import DemoPerson, Moment
from igrip.lab.simulation.demo_score import DemoScore
from igrip.lab.simulation.minimum_jerk import progress, reach


@pytest.fixture(scope="module")
def person() -> DemoPerson:
    return DemoPerson(load_objects("ycb"), seed=1)


def one_round(person: DemoPerson) -> list[Moment]:
    tasks = list(islice(person.tasks(), person.round))
    moments = []
    for moment in person:
        if moment.observation.t >= tasks[-1].finish:
            return moments
        moments.append(moment)
    raise AssertionError("unreachable")


def test_minimum_jerk_is_at_rest_at_both_ends() -> None:
    s = np.array([-1.0, 0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(progress(s), [0.0, 0.0, 0.5, 1.0, 1.0])
    for end in (0.0, 1.0):
        inside = abs(end - 1e-3)  # velocity and acceleration vanish: the way left is cubic
        assert abs(progress(np.array([inside]))[0] - end) == pytest.approx(1e-8, rel=0.01)


def test_reach_begins_and_ends_where_it_should() -> None:
    start, end = np.array([0.2, 0.0, 0.04]), np.array([0.0, 0.4, 0.1])
    points = reach(start, end, 0.06, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(points[[0, 2]], [start, end])
    np.testing.assert_allclose(points[1], 0.5 * (start + end) + [0.0, 0.0, 0.06])


def test_a_round_holds_every_object_hand_and_grip_once(person: DemoPerson) -> None:
    tasks = list(islice(person.tasks(), person.round))
    assert len({(t.target, t.hand, t.grip) for t in tasks}) == 16
    assert {t.target for t in tasks} == {"cracker", "soup", "mustard", "bleach"}


def test_the_same_seed_repeats_and_another_does_not() -> None:
    catalog = load_objects("ycb")

    def lines(seed: int) -> list[bytes]:
        return [m.observation.to_json() for m in islice(DemoPerson(catalog, seed), 50)]

    assert lines(3) == lines(3)
    assert lines(3) != lines(4)


def test_rates_ages_and_order(person: DemoPerson) -> None:
    moments = list(islice(person, 300))
    times = np.array([m.observation.t for m in moments])
    assert np.diff(times) == pytest.approx(np.full(299, 1 / 30))
    seen = [m for m in moments if m.observation.objects]
    assert len(seen) == pytest.approx(10 * 12, abs=2)
    poses = [(m.observation.t, pose) for m in seen[1:] for pose in m.observation.objects.values()]
    assert {round(t - pose.t, 9) for t, pose in poses} == {0.08}


def test_reaches_end_at_their_objects(person: DemoPerson) -> None:
    for task in islice(person.tasks(), 16):
        model, place = person.table.models[task.target], person.table.places[task.target]
        point = person.hands(task, task.end)[task.hand]
        turn = Rotation.from_euler("z", person.table.yaws[task.target])
        nearest = np.linalg.norm(turn.apply(model.vertices) + place - point, axis=1).min()
        assert 0.05 < nearest < 0.11
        above = point[2] - place[2] - model.origin[2]
        assert (above > 0.85 * 0.5 * model.length) == (task.grip == "pinch")


def test_the_estimator_gets_most_of_a_round_right(person: DemoPerson) -> None:
    estimator, tally = Estimator(load_objects("ycb")), DemoScore()
    lines = [tally.update(m, estimator.update(m.observation)) for m in one_round(person)]
    summary = tally.summary()
    assert summary["reaches"] == 16
    assert summary["targets_right"] >= 12
    assert summary["grips_right"] >= 14
    assert len([line for line in lines if line]) == 16
    assert "16 reaches" in tally.sentence()
