"""Features are pure numbers: no frame, no unit of length, no order; and a few known ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.geometry.cylinder import Cylinders
from igrip.lab.simulation.minimum_jerk import reach
from igrip.motion import reach_kernel as layout
from igrip.motion.reach_detection import ReachDetector
from igrip.targets.learned.features import LOCAL, SHARED, features_of
from oracle.features import Movement

OBJECTS = Cylinders.of(
    centre=np.array([[0.0, 0.40, 0.05], [0.2, 0.30, 0.10], [-0.3, 0.10, 0.0]]),
    axis=np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [1.0, 0.0, 0.0]]),
    half_length=np.array([0.10, 0.05, 0.08]),
    radius=np.array([0.03, 0.05, 0.02]),
    velocity=np.array([[0.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.0]]),
)


def moving(upto=0.6, noise=0.001):
    """Return the movement in the middle of a reach to the first object."""
    rng = np.random.default_rng(0)
    one = ReachDetector()
    for t in np.arange(0.0, 0.3 + upto, 1.0 / 60.0):
        [point] = reach(np.zeros(3), OBJECTS.centre[0], 0.03, np.array([t - 0.3]))
        last = one.update(t, point + noise * rng.normal(size=3))
    assert last.moving
    return last


def taken(cylinders, order):
    """Return some of the cylinders."""
    return Cylinders(cylinders.rows[order])


def changed(one, turn, shift, scale):
    """Return the same movement and objects in another frame and unit."""
    points = one.points.copy()
    points[:, 1:] = scale * turn.apply(points[:, 1:]) + shift
    state, now = one.state.copy(), np.empty((3, 3))
    state[layout.START : layout.START + 3] = scale * turn.apply(one.start) + shift
    state[[layout.MAX_SPEED, layout.PATH]] *= scale
    state[layout.NOISE2] *= scale**2
    now[0] = scale * turn.apply(one.now[0]) + shift
    now[1:] = scale * turn.apply(one.now[1:])
    moved = one._replace(state=state, points=points, now=now)
    objects = Cylinders.of(
        scale * turn.apply(OBJECTS.centre) + shift,
        turn.apply(OBJECTS.axis),
        scale * OBJECTS.half_length,
        scale * OBJECTS.radius,
        scale * turn.apply(OBJECTS.velocity),
    )
    return moved, objects


@pytest.mark.parametrize(("scale", "seed"), [(1.0, 1), (1000.0, 2), (0.01, 3)])
def test_frame_and_unit_do_not_matter(scale, seed):
    one = moving()
    turn = Rotation.random(random_state=seed)
    shift = np.random.default_rng(seed).normal(0.0, scale, 3)
    there = features_of(*changed(one, turn, shift, scale))
    for a, b in zip(features_of(one, OBJECTS), there, strict=True):
        assert b == pytest.approx(a, rel=1e-5, abs=1e-5)


def test_order_does_not_matter():
    one, order = moving(), [2, 0, 1]
    local, shared = features_of(one, OBJECTS)
    again, same = features_of(one, taken(OBJECTS, order))
    assert (again == local[order]).all()
    assert (same == shared).all()


def test_known_values_half_way():
    """Half of a straight minimum jerk: half done, at peak speed, heading for the object."""
    one = ReachDetector()
    for t in np.arange(0.0, 0.3 + 0.5 + 1e-9, 1.0 / 240.0):
        [point] = reach(np.zeros(3), np.array([0.0, 0.4, 0.0]), 0.0, np.array([t - 0.3]))
        last = one.update(t, point)
    objects = Cylinders.of(
        np.array([[0.0, 0.4, 0.0]]), np.array([[0.0, 0.0, 1.0]]), np.array([0.05]),
        np.array([0.03]), np.zeros((1, 3)),
    )  # fmt: skip
    local, shared = features_of(last, objects)
    told = dict(zip(LOCAL, local[0], strict=True)) | dict(zip(SHARED, shared, strict=True))
    assert told["progress"] == pytest.approx(0.5, abs=0.02)
    assert told["remaining"] == pytest.approx(0.5, abs=0.02)
    assert told["deviation"] == pytest.approx(0.0, abs=1e-3)
    assert told["heading_now"] == pytest.approx(1.0)
    assert told["speed_of_peak"] == pytest.approx(1.0, abs=0.01)
    assert told["nearness"] == pytest.approx(0.0)
    assert told["object_speed"] == 0.0
    # the half of the half way was done at 0.359 of the duration (10 s³ - 15 s⁴ + 6 s⁵ = 1/4)
    speed = np.linalg.norm(last.now[1])
    assert told["speed_since_half"] == pytest.approx(speed / 0.2 * (0.5 - 0.359), rel=0.04)


def test_every_number_is_bounded_whatever_comes():
    one = moving()
    objects = taken(OBJECTS, [0, 0, 0])
    objects.centre[0] = one.now[0]  # in the object
    objects.centre[1] = one.start  # back at the start
    objects.centre[2] = 1e6
    local, shared = features_of(one, objects)
    assert np.isfinite(local).all()
    assert (np.abs(local) <= 8.0).all()
    assert (np.abs(shared) <= 8.0).all()


def oracle_of(one, points=None):
    """Return the oracle's view of a movement."""
    return Movement(
        one.now, layout.times_of(one.state), one.start, one.points if points is None else points,
        *layout.extent_of(one.state), np.sqrt(layout.noise_variance_of(one.state)),
    )  # fmt: skip


def random_cylinders(rng, count):
    axes = rng.normal(size=(count, 3))
    return Cylinders.of(
        rng.uniform(-0.5, 0.5, (count, 3)), axes / np.linalg.norm(axes, axis=1, keepdims=True),
        rng.uniform(0.02, 0.15, count), rng.uniform(0.01, 0.08, count),
        rng.normal(0.0, 0.1, (count, 3)) * (rng.random(count) < 0.5)[:, None],
    )  # fmt: skip


@pytest.mark.parametrize("upto", [0.25, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("seed", range(3))
def test_every_feature_is_that_of_plain_numpy(upto, seed):
    one, cylinders = moving(upto), random_cylinders(np.random.default_rng(seed), 5)
    local, shared = features_of(one, cylinders)
    oracle = oracle_of(one)
    parts = (
        cylinders.centre, cylinders.axis, cylinders.half_length, cylinders.radius,
        cylinders.velocity,
    )  # fmt: skip
    expected = oracle.all_local(parts)
    for row, named in zip(local, expected, strict=True):
        found = dict(zip(LOCAL, row, strict=True))
        assert found == pytest.approx(named, rel=1e-6, abs=1e-7)
    assert dict(zip(SHARED, shared, strict=True)) == pytest.approx(oracle.shared(), rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_absurd_movements_are_bounded_like_those_of_plain_numpy(seed):
    """Any numbers, as no hand moves: many features reach their bounds."""
    rng = np.random.default_rng(seed)
    one = moving()
    state, count = one.state.copy(), 12
    state[layout.TIME], state[layout.ONSET] = 5.0, 5.0 - rng.choice([1e-5, 0.3, 4.0])
    state[layout.MAX_SPEED], state[layout.MAX_SPEED_TIME] = rng.uniform(0, 3), 4.9
    state[layout.PATH] = rng.uniform(0.0, 2.0)
    state[layout.START : layout.START + 3] = rng.normal(0.0, 0.01, 3)
    points = np.column_stack([np.linspace(4.0, 5.0, count), rng.normal(0.0, 0.03, (count, 3))])
    now = rng.normal(0.0, [[0.02], [2.0], [30.0]], (3, 3))
    one = one._replace(state=state, points=points, now=now)
    cylinders = random_cylinders(rng, 4)
    parts = (
        cylinders.centre, cylinders.axis, cylinders.half_length, cylinders.radius,
        cylinders.velocity,
    )  # fmt: skip
    local, shared = features_of(one, cylinders)
    oracle = oracle_of(one)
    assert dict(zip(SHARED, shared, strict=True)) == pytest.approx(oracle.shared(), rel=1e-9)
    for row, named in zip(local, oracle.all_local(parts), strict=True):
        assert dict(zip(LOCAL, row, strict=True)) == pytest.approx(named, rel=1e-6, abs=1e-7)
    assert (np.abs(np.concatenate([local.ravel(), shared])) == 8.0).any()


def test_an_object_that_moves_is_looked_at_as_if_it_stood():
    """The hand meets an object that is brought: seen from it, the way began further off."""
    one = moving()
    t, onset = one.state[layout.TIME], one.onset
    drift = np.array([0.0, -0.2, 0.0])  # m/s
    times = np.linspace(onset - 0.1, t, 40)
    path = np.column_stack([times, OBJECTS.centre[0] + np.outer(times - t, drift)])
    rows = OBJECTS.rows[:1].copy()
    brought = Cylinders.of(
        OBJECTS.centre[:1], OBJECTS.axis[:1], OBJECTS.half_length[:1], OBJECTS.radius[:1],
        drift[None],
    )._replace(paths={0: path})  # fmt: skip
    [seen], [stood] = features_of(one, brought).local, features_of(one, Cylinders(rows)).local
    left, way = LOCAL.index("remaining"), np.linalg.norm(OBJECTS.centre[0] - one.start)
    further = np.linalg.norm(OBJECTS.centre[0] - one.start - drift * (t - onset))
    assert seen[left] / stood[left] == pytest.approx(way / further, rel=0.05)
    assert seen[LOCAL.index("object_speed")] == 0.0


def test_a_hand_that_began_beside_an_object_carries_it():
    one = moving()
    path = one.points.copy()  # the object moves as the hand does
    carried = Cylinders.of(
        one.now[:1], np.array([[0.0, 0.0, 1.0]]), np.array([0.05]), np.array([0.03]), one.now[1:2]
    )
    known = features_of(one, carried).local
    np.testing.assert_array_equal(features_of(one, carried._replace(paths={0: path})).local, known)
    assert known[0, LOCAL.index("object_speed")] == pytest.approx(1.0)
