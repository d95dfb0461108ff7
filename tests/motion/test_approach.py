"""A movement seen from a body that moves, against the same movement towards one that stands."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.lab.simulation.minimum_jerk import reach
from igrip.motion.approach import MAX_AHEAD, approach_of
from igrip.motion.reach_detection import ReachDetector
from igrip.motion.reach_kernel import extent_of, start_of, times_of

TIMES = np.arange(0.0, 0.9, 1.0 / 60.0)
DRIFT = np.array([0.05, -0.12, 0.03])  # m/s


def followed(points):
    detector = ReachDetector()
    for t, point in zip(TIMES.tolist(), points, strict=True):
        last = detector.update(t, point)
    assert last.moving
    return last


def standing():
    return reach(np.zeros(3), np.array([0.1, 0.4, 0.05]), 0.03, (TIMES - 0.3) / 1.2)


def test_a_body_that_stands_changes_nothing_but_how_speeds_are_measured():
    one = followed(standing())
    path = np.column_stack([TIMES[::6], np.tile([0.3, 0.2, 0.1], (len(TIMES[::6]), 1))])
    seen, ahead = approach_of(one, path, np.zeros(3))
    np.testing.assert_allclose(seen.points, one.points, atol=1e-12)
    np.testing.assert_allclose(seen.now, one.now)
    np.testing.assert_allclose(start_of(seen.state), one.start)
    assert extent_of(seen.state) == pytest.approx(extent_of(one.state), rel=0.1)
    assert times_of(seen.state)[2] == pytest.approx(times_of(one.state)[2], abs=0.1)
    np.testing.assert_array_equal(ahead, 0.0)


def test_hand_and_body_that_drift_together_are_seen_as_if_both_stood():
    """The reach begins while the hand drifts along, so only what came after its onset is asked."""
    detector, drifting = ReachDetector(), standing() + DRIFT * TIMES[:, None]
    for t, point in zip(TIMES.tolist(), drifting, strict=True):
        last = detector.update(t, point)
    path = np.column_stack([TIMES, np.array([0.1, 0.4, 0.05]) + DRIFT * TIMES[:, None]])
    seen, _ = approach_of(last, path, DRIFT)
    here = DRIFT * TIMES[-1]  # the body as it is now
    # the points are fitted, so not exactly these
    known = np.searchsorted(TIMES, seen.points[:, 0] - 1e-9)
    np.testing.assert_allclose(
        seen.points[:, 1:], standing()[known] + here, atol=2e-3
    )  # they are fitted
    np.testing.assert_allclose(seen.now[1], last.now[1] - DRIFT)
    np.testing.assert_allclose(seen.now[0], last.now[0])


@pytest.mark.parametrize("late", [0.0, 0.1, 5.0])
def test_a_pose_that_is_late_is_extrapolated_up_to_a_bound(late):
    one = followed(standing())
    newest = TIMES[-1] - late
    path = np.array([[newest - 0.1, 0.0, 0.0, 0.0], [newest, *(0.1 * DRIFT)]])
    _, ahead = approach_of(one, path, DRIFT)
    np.testing.assert_allclose(ahead, min(late, MAX_AHEAD) * DRIFT, atol=1e-12)


def test_the_movement_itself_is_left_alone():
    one = followed(standing())
    before = [part.copy() for part in (one.state, one.points, one.now)]
    approach_of(one, np.column_stack([TIMES, np.outer(TIMES, DRIFT)]), DRIFT)
    for part, kept in zip((one.state, one.points, one.now), before, strict=True):
        np.testing.assert_array_equal(part, kept)
