"""The generator of handovers: objects that are brought to where the hand takes them, seeded."""

from __future__ import annotations

import numpy as np

from training.handovers import MODES, OBJECT_RATES, simulate_handovers
from training.moments import catalog


def recordings(people=12):
    return [r for number in range(people) for r in simulate_handovers(5, number)]


def brought_to(recording):
    """Return where the middle of the moving object was last seen."""
    pose = [m.objects["o0"] for m in recording.messages if "o0" in m.objects][-1]
    return np.array(pose.position) + catalog()[pose.model].origin


def test_every_mode_is_there_and_targets_are_as_they_say():
    modes = {r.kind for r in recordings()}
    assert modes == set(MODES)
    for one in recordings():
        assert (one.target == "o0") == (one.kind == "handover")
        assert (one.target is None) == (one.kind == "carrying")
        if one.target is not None:
            assert 0.0 <= one.onset < one.end <= one.messages[-1].t


def test_a_hand_that_takes_ends_at_the_object_and_one_that_carries_stays_with_it():
    for one in recordings():
        palms = np.array([m.hands["right"].position for m in one.messages])
        if one.kind == "handover":
            model = catalog()[one.messages[0].objects["o0"].model]
            away = np.linalg.norm(palms[-1] - brought_to(one))
            assert away < model.radius + 0.05 + 0.08  # the gap, and an impaired arm's miss
        elif one.kind == "carrying":
            poses = [m.objects["o0"].position for m in one.messages if "o0" in m.objects]
            moved = np.ptp(np.array(poses), axis=0)
            np.testing.assert_allclose(moved, np.ptp(palms, axis=0), atol=0.12)


def test_poses_come_at_the_rate_of_their_sensor():
    for one in recordings():
        times = [m.t for m in one.messages if "o0" in m.objects]
        assert np.diff(times).mean() > 0.9 / max(OBJECT_RATES)


def test_a_seed_gives_the_same_person():
    assert simulate_handovers(5, 3) == simulate_handovers(5, 3)
    assert simulate_handovers(5, 3) != simulate_handovers(5, 4)
