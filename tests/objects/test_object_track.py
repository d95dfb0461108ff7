"""One object over time: filtered pose, velocity of its centre, reason."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.gating import GatingConfig
from igrip.objects.object_track import PATH_SPAN, PATH_STEP, ObjectConfig, ObjectTrack
from oracle import filters
from oracle.pipeline import OBJECT_ORIENTATION, OBJECT_POSITION
from support import BOX, random_turn


def track(catalog, model=BOX, **config):
    return ObjectTrack("box", model, catalog, ObjectConfig(**config), GatingConfig())


def seen(track, now, position, turn=None, **more):
    turn = Rotation.identity() if turn is None else turn
    track.update(
        now, ObjectPose(position=list(position), orientation=turn.as_quat().tolist(), **more)
    )
    track.advance(now)


def velocity(track, lever):
    """Return the velocity of a point, given relative to the object's origin in the world."""
    local = track.place(np.zeros(3)).rotation.T @ lever
    return track.place(local).velocity


def test_pose_agrees_with_the_oracle(shapes):
    rng = np.random.default_rng(1)
    times = 1.0 + np.cumsum(rng.uniform(0.05, 0.12, 30))
    points = np.cumsum(rng.normal(0.0, 0.01, (30, 3)), axis=0)
    turns, turn = [], random_turn(rng)
    for _ in range(30):
        turn = Rotation.from_rotvec(rng.normal(0.0, 0.1, 3)) * turn
        turns.append(turn)
    expected, _, _ = filters.one_euro_points(times, points, **OBJECT_POSITION)
    rotations, _, _ = filters.one_euro_rotations(
        times, Rotation.concatenate(turns).as_quat(), **OBJECT_ORIENTATION
    )
    ours = track(shapes)
    for k in range(30):
        seen(ours, times[k] + 0.05, points[k], turns[k], t=times[k])
        assert ours.place(np.zeros(3)).translation == pytest.approx(
            expected[k], rel=1e-9, abs=1e-12
        )
        assert ours.place(np.zeros(3)).rotation == pytest.approx(rotations[k].as_matrix(), abs=1e-9)


def test_not_seen_yet_and_unknown(shapes):
    assert track(shapes).reason == "not detected yet"
    ghost = track(shapes, model="ghost")
    assert "no model 'ghost'" in ghost.reason
    assert ghost.fault == ghost.reason
    assert ghost.model is None
    seen(ghost, 1.0, (0, 0, 0))
    assert "no model 'ghost'" in ghost.reason


@pytest.mark.parametrize("static", [True, False])
def test_age(shapes, static):
    ours = track(shapes)
    seen(ours, 1.0, (0.1, 0.0, 0.0), static=static)
    assert ours.reason is None
    ours.advance(2.99)
    assert ours.reason is None
    ours.advance(3.01)
    assert ours.reason == (None if static else "not detected for too long")
    assert ours.fault is None


def test_a_pose_that_is_old_when_it_comes(shapes):
    ours = track(shapes)
    seen(ours, 10.0, (0.1, 0.0, 0.0), t=7.0)
    assert ours.reason == "not detected for too long"


def test_a_resting_object_has_no_velocity(shapes):
    rng = np.random.default_rng(2)
    ours = track(shapes)
    for k in range(30):
        seen(ours, 1.0 + k / 12, rng.normal(0.0, 0.0005, 3))
        assert velocity(ours, np.array([0.0, 0.0, 0.05])).tolist() == [0.0, 0.0, 0.0]


def test_a_static_object_has_no_velocity(shapes):
    ours = track(shapes)
    for k in range(10):
        seen(ours, 1.0 + k / 12, (0.05 * k, 0.0, 0.0), static=True)
    assert velocity(ours, np.zeros(3)).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("rate", [12.0, 30.0])
@pytest.mark.parametrize("speed", [0.2, 0.5])
def test_velocity_of_an_object_in_steady_motion(shapes, rate, speed):
    """The distance derivative wants the velocity itself, not the filter's view of its lag."""
    ours = track(shapes)
    for k in range(int(3 * rate)):
        seen(ours, 1.0 + k / rate, (speed * k / rate, 0.0, 0.0))
    assert velocity(ours, np.zeros(3)) == pytest.approx([speed, 0, 0], rel=0.1)


def test_the_velocity_of_the_centre_of_a_turning_object(shapes):
    """About its own origin: ω × r."""
    ours = track(shapes, orientation={"min_cutoff": 1e4, "beta": 0.0, "derivative_cutoff": 1e3})
    for k in range(40):
        seen(ours, 1.0 + k / 30, (0, 0, 0), Rotation.from_rotvec([0.0, 0.0, 2.0 * k / 30]))
    lever = np.array([0.1, 0.0, 0.3])
    assert velocity(ours, lever) == pytest.approx([0.0, 0.2, 0.0], abs=0.01)


def test_a_refused_pose_is_named_and_the_last_good_one_kept(shapes):
    ours = track(shapes)
    seen(ours, 1.0, (0.1, 0.0, 0.0))
    seen(ours, 1.1, (5.0, 0.0, 0.0))
    assert "jumped" in ours.fault
    assert ours.reason is None
    assert ours.place(np.zeros(3)).translation.tolist() == [0.1, 0.0, 0.0]
    ours.advance(3.2)
    assert ours.reason is not None  # it is as old as its last good pose
    seen(ours, 3.3, (0.1, 0.0, 0.0))
    assert (ours.reason, ours.fault) == (None, None)


def test_an_object_that_was_never_believed_has_no_pose(shapes):
    ours = track(shapes)
    seen(ours, 1.0, (1e6, 0.0, 0.0))
    assert "unit" in ours.reason
    assert ours.fault == ours.reason


def test_looked_for_and_not_seen_ends_static(shapes):
    ours = track(shapes)
    seen(ours, 1.0, (0.1, 0.0, 0.0), static=True)
    ours.advance(50.0)
    assert ours.reason is None
    ours.miss(50.0)
    ours.advance(51.9)
    assert ours.reason is None
    ours.miss(51.9)  # it ages from the first miss on
    ours.advance(52.1)
    assert ours.reason == "not detected for too long"
    assert ours.gate.counts["missed"] == 2


def test_after_a_gap_the_filters_begin_anew(shapes):
    ours = track(shapes)
    for k in range(5):
        seen(ours, 1.0 + k / 12, (0.01 * k, 0.0, 0.0))
    seen(ours, 9.0, (3.0, 1.0, 0.0), Rotation.from_rotvec([1.0, 0.0, 0.0]))
    assert ours.place(np.zeros(3)).translation.tolist() == [3.0, 1.0, 0.0]
    assert ours.place(np.zeros(3)).rotation == pytest.approx(
        Rotation.from_rotvec([1.0, 0, 0]).as_matrix()
    )
    assert velocity(ours, np.zeros(3)).tolist() == [0.0, 0.0, 0.0]


@given(
    steps=st.lists(
        st.tuples(st.floats(0.005, 1.2), st.sampled_from([0.0, 0.0, 0.004, 0.02, 0.2]),
                  st.integers(0, 2)),
        max_size=120,
    )
)  # fmt: skip
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
def test_the_path_is_that_of_the_last_seconds_if_the_object_moved_in_them(shapes, steps):
    """An oracle that looks at every place again; the track looks only where its bounds allow it."""
    ours = ObjectTrack("box", BOX, shapes, ObjectConfig(), GatingConfig(jump_speed=1e3))
    kept, t, place = [], 0.0, [0.0, 0.0, 0.0]
    for k, (dt, step, axis) in enumerate(steps):
        t += dt
        place[axis] += step if k % 2 else -step
        seen(ours, t, place)
        if ours.gate.counts["restarts"]:
            ours.gate.counts["restarts"], kept = 0, []
        if len(kept) > 1 and t - kept[-2][0] < PATH_STEP:
            kept.pop()
        kept = [row for row in [*kept, (t, *place)] if t - row[0] <= PATH_SPAN]
        rows = np.array(kept)
        moved = len(kept) > 1 and np.ptp(rows[:, 1:], axis=0).max() > ObjectConfig().rest_distance
        if moved:
            np.testing.assert_array_equal(ours.path, rows)
        else:
            assert ours.path is None
