"""One-Euro filters against the oracle, and the properties a filter has to have."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.motion.filters import (
    OneEuroConfig,
    OrientationFilter,
    PoseFilter,
    PositionFilter,
    smoothing,
)
from oracle import filters
from support import random_turn

CONFIGS = [
    {"min_cutoff": 1.5, "beta": 5.0, "derivative_cutoff": 1.0},
    {"min_cutoff": 1.0, "beta": 0.0, "derivative_cutoff": 1e-3},
    {"min_cutoff": 0.01, "beta": 100.0, "derivative_cutoff": 50.0},
]


def uneven(rng, count):
    return np.cumsum(rng.uniform(0.001, 0.2, count))


def turning(rng, count, size):
    steps = Rotation.from_rotvec(rng.normal(0.0, size, (count, 3)))
    result = [random_turn(rng)]
    for step in steps[1:]:
        result.append(step * result[-1])
    return Rotation.concatenate(result)


@pytest.mark.parametrize("options", CONFIGS)
@pytest.mark.parametrize("seed", range(3))
def test_points_agree_with_the_oracle(options, seed):
    rng = np.random.default_rng(seed)
    times, points = uneven(rng, 60), np.cumsum(rng.normal(0.0, 0.03, (60, 3)), axis=0)
    expected, slope, velocity = filters.one_euro_points(times, points, **options)
    ours = PositionFilter(OneEuroConfig(**options))
    for k in range(60):
        assert ours.update(times[k], tuple(points[k])) == pytest.approx(expected[k], rel=1e-12)
        assert ours.derivative == pytest.approx(slope[k], rel=1e-10, abs=1e-12)
        assert ours.velocity == pytest.approx(velocity[k], rel=1e-9, abs=1e-12)
        assert ours.value == pytest.approx(expected[k], rel=1e-12)


@pytest.mark.parametrize("options", CONFIGS)
@pytest.mark.parametrize("size", [1e-5, 0.1, 1.0])
def test_rotations_agree_with_the_oracle(options, size):
    rng = np.random.default_rng(4)
    times, turns = uneven(rng, 40), turning(rng, 40, size)
    expected, slope, velocity = filters.one_euro_rotations(times, turns.as_quat(), **options)
    ours = OrientationFilter(OneEuroConfig(**options))
    for k in range(40):
        q = ours.update(times[k], tuple(turns[k].as_quat()))
        apart = Rotation.from_quat(q) * expected[k].inv()
        assert apart.magnitude() < 1e-7 * min(1.0, size * 100.0)
        assert ours.derivative == pytest.approx(slope[k], rel=1e-7, abs=1e-9)
        assert ours.velocity == pytest.approx(velocity[k], rel=1e-7, abs=1e-9)
        assert math.hypot(*q) == pytest.approx(1.0, abs=1e-12)


def test_the_sign_of_a_quaternion_does_not_matter():
    rng = np.random.default_rng(5)
    times, turns = uneven(rng, 30), turning(rng, 30, 0.2).as_quat()
    plain, flipped = (OrientationFilter(OneEuroConfig()) for _ in range(2))
    for k in range(30):
        a = plain.update(times[k], tuple(turns[k]))
        b = flipped.update(times[k], tuple(turns[k] * rng.choice([-1.0, 1.0])))
        assert abs(np.dot(a, b)) == pytest.approx(1.0, abs=1e-12)
        assert plain.derivative == pytest.approx(flipped.derivative, abs=1e-9)


@given(st.integers(0, 10_000))
def test_points_turn_with_the_frame(seed):
    rng = np.random.default_rng(seed)
    turn, shift = random_turn(rng), rng.uniform(-2.0, 2.0, 3)
    here, there = (PositionFilter(OneEuroConfig()) for _ in range(2))
    times = uneven(rng, 15)
    for t, point in zip(times, np.cumsum(rng.normal(0, 0.05, (15, 3)), axis=0), strict=True):
        a = here.update(t, tuple(point))
        b = there.update(t, tuple(turn.apply(point) + shift))
        assert turn.apply(a) + shift == pytest.approx(np.array(b), abs=1e-12)


@given(st.integers(0, 10_000))
def test_rotations_turn_with_the_world_and_with_the_body(seed):
    rng = np.random.default_rng(seed)
    world, body = random_turn(rng), random_turn(rng)
    here, there = (OrientationFilter(OneEuroConfig()) for _ in range(2))
    times, turns = uneven(rng, 15), turning(rng, 15, 0.3)
    for t, turn in zip(times, turns, strict=True):
        a = Rotation.from_quat(here.update(t, tuple(turn.as_quat())))
        b = Rotation.from_quat(there.update(t, tuple((world * turn * body).as_quat())))
        assert ((world * a * body) * b.inv()).magnitude() < 1e-9


@given(st.lists(st.tuples(*[st.floats(-1, 1)] * 3), min_size=2, max_size=20), st.integers(0, 99))
def test_a_filtered_point_stays_within_the_box_of_its_samples(points, seed):
    times = uneven(np.random.default_rng(seed), len(points))
    ours = PositionFilter(OneEuroConfig())
    values = [ours.update(t, p) for t, p in zip(times, points, strict=True)]
    seen = np.array(points)
    assert (np.array(values) >= seen.min(axis=0) - 1e-12).all()
    assert (np.array(values) <= seen.max(axis=0) + 1e-12).all()


def test_first_sample_passes_and_rest_is_kept():
    ours = PositionFilter(OneEuroConfig())
    assert ours.value is None
    for k in range(10):
        assert ours.update(0.1 * k, (1.0, -2.0, 3.0)) == (1.0, -2.0, 3.0)
    assert ours.derivative == ours.velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("rate", [12.0, 30.0, 120.0])
def test_velocity_of_a_steady_motion_is_its_velocity(rate):
    """The derivative is not: it holds the lag, and would say twice the speed at 30 Hz."""
    ours, turning = PositionFilter(OneEuroConfig()), OrientationFilter(OneEuroConfig())
    for k in range(int(3 * rate)):
        t = k / rate
        ours.update(t, (0.3 * t, 0.0, -0.4 * t))
        turning.update(t, tuple(Rotation.from_rotvec([0.0, 0.5 * t, 0.0]).as_quat()))
    assert ours.velocity == pytest.approx((0.3, 0.0, -0.4), rel=1e-3)
    assert turning.velocity == pytest.approx((0.0, 0.5, 0.0), rel=1e-3, abs=1e-9)
    assert math.hypot(*ours.derivative) > 0.51


def test_a_fast_hand_is_followed_closely():
    # the reason for the derivative cutoff of 1 Hz: a fixed 1 Hz low-pass lags a reach by 10 cm
    speed, lags = 1.0, []
    for derivative_cutoff in (1.0, 1e-8):
        config = OneEuroConfig(min_cutoff=1.0, beta=5.0, derivative_cutoff=derivative_cutoff)
        ours = PositionFilter(config)
        for k in range(31):
            value = ours.update(k / 30, (speed * k / 30, 0.0, 0.0))
        lags.append(speed * 30 / 30 - value[0])
    assert lags[0] < 0.04
    assert lags[1] > 0.10


@given(st.floats(1e-3, 1e3), st.floats(1e-6, 1e3))
def test_smoothing_is_a_weight_that_grows_with_cutoff_and_time(cutoff, dt):
    weight = smoothing(cutoff, dt)
    assert 0.0 < weight < 1.0 or weight == pytest.approx(1.0)
    assert weight == pytest.approx(filters.alpha(cutoff, dt), rel=1e-12)
    assert smoothing(2.0 * cutoff, dt) >= weight
    assert smoothing(cutoff, 2.0 * dt) >= weight


def posed(count=30, turning_by=0.3, options=CONFIGS[0], length=1.0):
    """Return a filter of poses and one of each kind, after the same samples."""
    rng = np.random.default_rng(6)
    config = OneEuroConfig(**options)
    times, turns = uneven(rng, count), turning(rng, count, turning_by).as_quat()
    points = np.cumsum(rng.normal(0.0, 0.05, (count, 3)), axis=0)
    pose, point, turn = (
        PoseFilter(config, config),
        PositionFilter(config),
        OrientationFilter(config),
    )
    for t, p, q in zip(times, points, turns, strict=True):
        pose.update(t, tuple(p), tuple(length * q))
        point.update(t, tuple(p))
        turn.update(t, tuple(q))
    return pose, point, turn


@pytest.mark.parametrize("count", [1, 2, 30])
@pytest.mark.parametrize("length", [1.0, 0.996])  # of a quaternion that is not quite of unit length
def test_a_filter_of_poses_is_one_of_each_kind(count, length):
    pose, point, turn = posed(count, length=length)
    assert pose.position.value == pytest.approx(point.value, abs=1e-15)
    assert pose.position.velocity == pytest.approx(point.velocity, abs=1e-12)
    assert pose.orientation.value == pytest.approx(turn.value, abs=1e-12)
    assert pose.orientation.velocity == pytest.approx(turn.velocity, abs=1e-10)


def test_nothing_has_begun_before_the_first_sample():
    assert OrientationFilter(OneEuroConfig()).value is None
    pose = PoseFilter(OneEuroConfig(), OneEuroConfig())
    assert not pose.begun
    pose.update(0.0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    assert pose.begun
    assert pose.orientation.value == (0.0, 0.0, 0.0, 1.0)


def test_a_placed_point_is_that_of_rigid_motion():
    """v + ω × r, with rotation and translation as scipy makes them."""
    pose, point, turn = posed()
    local = np.array([0.1, -0.2, 0.05])
    placed = pose.place(local, 0.0)
    rotation = Rotation.from_quat(turn.value)
    assert placed.rotation == pytest.approx(rotation.as_matrix(), abs=1e-12)
    assert placed.translation == pytest.approx(np.array(point.value), abs=1e-12)
    assert placed.point == pytest.approx(rotation.apply(local) + point.value, abs=1e-12)
    velocity = np.array(point.velocity) + np.cross(turn.velocity, rotation.apply(local))
    assert placed.velocity == pytest.approx(velocity, abs=1e-10)
    assert [array.shape for array in placed] == [(3, 3), (3,), (3,), (3,)]


@pytest.mark.parametrize(("part", "rests"), [(0.999, False), (1.001, True)])
def test_a_placed_point_that_is_slower_than_the_rest_speed_rests(part, rests):
    pose, *_ = posed()
    speed = float(np.linalg.norm(pose.place(np.zeros(3), 0.0).velocity))
    velocity = pose.place(np.zeros(3), part * speed).velocity
    assert velocity.tolist() == [0.0, 0.0, 0.0] if rests else np.linalg.norm(velocity) == speed


@pytest.mark.parametrize("size", [1e-12, 1e-7, 1e-5, 2e-4])
def test_small_turns_lose_no_digits(size):
    """Where sines are replaced by their series."""
    config = OneEuroConfig(min_cutoff=1.0, beta=0.0, derivative_cutoff=1.0)
    ours, axis = OrientationFilter(config), np.array([0.6, 0.0, -0.8])
    ours.update(0.0, (0.0, 0.0, 0.0, 1.0))
    turned = Rotation.from_rotvec(size * axis)
    ours.update(0.1, tuple(turned.as_quat()))
    weight = filters.alpha(1.0, 0.1)
    found = Rotation.from_quat(ours.value).as_rotvec()
    assert found == pytest.approx(weight * size * axis, rel=1e-8, abs=1e-18)
    assert ours.derivative == pytest.approx(weight * size * axis / 0.1, rel=1e-6)
