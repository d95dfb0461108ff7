"""Features are pure numbers: no frame, no unit of length, no order; and a few known ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.lab.simulation.minimum_jerk import reach
from igrip.motion import noise
from igrip.motion import reach_detection as course
from igrip.motion.reach_detection import ReachDetector
from igrip.targets.learned.features import LOCAL, SHARED, describe

OBJECTS = np.array([
    [0.0, 0.40, 0.05, 0.0, 0.0, 1.0, 0.10, 0.03, 0.0, 0.0, 0.0],
    [0.2, 0.30, 0.10, 0.6, 0.0, 0.8, 0.05, 0.05, 0.0, 0.1, 0.0],
    [-0.3, 0.10, 0.0, 1.0, 0.0, 0.0, 0.08, 0.02, 0.0, 0.0, 0.0],
])  # fmt: skip


def moving(upto=0.6, noise=0.001):
    """Return the movement in the middle of a reach to the first object."""
    rng = np.random.default_rng(0)
    one = ReachDetector()
    for t in np.arange(0.0, 0.3 + upto, 1.0 / 60.0):
        [point] = reach(np.zeros(3), OBJECTS[0, :3], 0.03, np.array([t - 0.3]))
        last = one.update(t, point + noise * rng.normal(size=3))
    assert last.moving
    return last


def described(one, objects, state=None, points=None, now=None):
    local, shared = np.empty((len(objects), len(LOCAL))), np.empty(len(SHARED))
    describe(
        one.state if state is None else state, one.points if points is None else points,
        one.now if now is None else now, objects, local, shared,
    )  # fmt: skip
    return local, shared


def changed(one, turn, shift, scale):
    """Return state, points, result and objects of the same movement in another frame and unit."""
    state, points, now = one.state.copy(), one.points.copy(), one.now.copy()
    objects = OBJECTS.copy()
    for first in (course.START, course.LAST):
        state[first : first + 3] = scale * turn.apply(state[first : first + 3]) + shift
    state[course.CALM : course.CALM + 3] = scale * turn.apply(state[course.CALM : course.CALM + 3])
    state[[course.PEAK, course.PATH]] *= scale
    state[course.NOISE + noise.VARIANCE] *= scale**2
    points[:, 1:] = scale * turn.apply(points[:, 1:]) + shift
    now[:3] = scale * turn.apply(now[:3]) + shift
    now[3:6], now[6:] = scale * turn.apply(now[3:6]), scale * turn.apply(now[6:])
    objects[:, :3] = scale * turn.apply(objects[:, :3]) + shift
    objects[:, 3:6] = turn.apply(objects[:, 3:6])
    objects[:, 6:8] *= scale
    objects[:, 8:] = scale * turn.apply(objects[:, 8:])
    return state, points, now, objects


@pytest.mark.parametrize(("scale", "seed"), [(1.0, 1), (1000.0, 2), (0.01, 3)])
def test_frame_and_unit_do_not_matter(scale, seed):
    one = moving()
    turn = Rotation.random(random_state=seed)
    shift = np.random.default_rng(seed).normal(0.0, scale, 3)
    state, points, now, objects = changed(one, turn, shift, scale)
    there = described(one, objects, state, points, now)
    for a, b in zip(described(one, OBJECTS), there, strict=True):
        assert b == pytest.approx(a, rel=1e-5, abs=1e-5)


def test_order_does_not_matter():
    one, order = moving(), [2, 0, 1]
    local, shared = described(one, OBJECTS)
    again, same = described(one, OBJECTS[order])
    assert (again == local[order]).all()
    assert (same == shared).all()


def test_known_values_half_way():
    """Half of a straight minimum jerk: half done, at peak speed, heading for the object."""
    one = ReachDetector()
    for t in np.arange(0.0, 0.3 + 0.5 + 1e-9, 1.0 / 240.0):
        [point] = reach(np.zeros(3), np.array([0.0, 0.4, 0.0]), 0.0, np.array([t - 0.3]))
        last = one.update(t, point)
    objects = np.array([[0.0, 0.4, 0.0, 0.0, 0.0, 1.0, 0.05, 0.03, 0.0, 0.0, 0.0]])
    local, shared = described(last, objects)
    told = dict(zip(LOCAL, local[0], strict=True)) | dict(zip(SHARED, shared, strict=True))
    assert told["progress"] == pytest.approx(0.5, abs=0.02)
    assert told["remaining"] == pytest.approx(0.5, abs=0.02)
    assert told["deviation"] == pytest.approx(0.0, abs=1e-3)
    assert told["heading_now"] == pytest.approx(1.0)
    assert told["speed_of_peak"] == pytest.approx(1.0, abs=0.01)
    assert told["nearness"] == pytest.approx(0.0)
    assert told["object_speed"] == 0.0
    # the half of the half way was done at 0.359 of the duration (10 s³ - 15 s⁴ + 6 s⁵ = 1/4)
    speed = np.linalg.norm(last.now[3:6])
    assert told["speed_since_half"] == pytest.approx(speed / 0.2 * (0.5 - 0.359), rel=0.04)


def test_every_number_is_bounded_whatever_comes():
    one = moving()
    objects = np.repeat(OBJECTS[:1], 3, axis=0)
    objects[0, :3] = one.now[:3]  # in the object
    objects[1, :3] = one.state[course.START : course.START + 3]  # back at the start
    objects[2, :3] = 1e6
    local, shared = described(one, objects)
    assert np.isfinite(local).all()
    assert (np.abs(local) <= 8.0).all()
    assert (np.abs(shared) <= 8.0).all()
