"""Cones, culling and contact of the compiled kernel, against plain numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.geometry import kernel
from igrip.geometry.scene import RayConfig, Scene, ray_pattern
from oracle import cones, meshes
from support import BOX, CAN, random_turn

CONE = Scene(RayConfig())._cone
VECTORS = st.tuples(*[st.floats(-1.0, 1.0)] * 3).map(np.array)
LONG = VECTORS.filter(lambda v: np.linalg.norm(v) > 0.05)


@pytest.mark.parametrize("rays", [1, 2, 3, 36, 100])
def test_pattern(rays):
    pattern = ray_pattern(rays)
    assert pattern == pytest.approx(cones.pattern(rays), abs=1e-12)
    assert pattern.shape == (rays, 2)
    assert pattern[0].tolist() == [0.0, 0.0]
    radius = np.hypot(*pattern.T)
    assert radius.max() == pytest.approx(1.0 if rays > 1 else 0.0)
    if rays == 100:  # evenly spread: as many rays per area near the rim as near the axis
        assert (radius < math.sqrt(0.5)).sum() == pytest.approx(50, abs=1)


@pytest.mark.parametrize("speed", [0.0, 0.03, 0.2, 0.415, 0.7999, 0.8, 3.0])
def test_half_angle(speed):
    assert math.atan(kernel.cone_tangent(speed, CONE)) == pytest.approx(cones.half_angle(speed))


@given(st.floats(0.0, 2.0), st.floats(0.0, 2.0))
def test_a_faster_point_has_no_wider_cone(a, b):
    slow, fast = sorted((a, b))
    assert kernel.cone_tangent(slow, CONE) >= kernel.cone_tangent(fast, CONE) - 1e-15


def frame_of(p, v, middle, axes=None):
    frame = np.empty((3, 3))
    axes = np.eye(3) if axes is None else axes
    kernel.cone_frame(p, v, np.append(middle, 1.0), axes, frame)
    return frame


@given(LONG, LONG, LONG)
def test_cone_frame_is_orthonormal_and_leans_towards_the_middle(p, v, middle):
    frame = frame_of(p, v, middle)
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=1e-9)
    assert frame[0] == pytest.approx(v / np.linalg.norm(v))
    assert frame[1] @ (middle - p) >= -1e-9
    assert frame[2] @ (middle - p) == pytest.approx(0.0, abs=1e-9)


@given(LONG, LONG)
def test_a_cone_that_points_at_the_middle_takes_its_roll_from_the_axes_of_the_object(p, v):
    axes = random_turn(np.random.default_rng(1)).as_matrix()
    frame = frame_of(p, v, p + 0.7 * v, axes)
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-9)
    # at right angles to the cone's axis and in one plane with it and the object's z
    assert np.cross(frame[0], axes[:, 2]) @ frame[1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("velocity", [(0, 0, 1), (0, 0, -1)])
def test_the_roll_is_defined_even_along_the_axis_of_the_object(velocity):
    frame = frame_of(np.zeros(3), np.array(velocity, dtype=float), np.array(velocity) * 0.3)
    assert frame @ frame.T == pytest.approx(np.eye(3))


@given(LONG, LONG, LONG)
def test_directions_agree_with_the_oracle(p, v, middle):
    frame = frame_of(p, v, middle)
    tangent = kernel.cone_tangent(float(np.linalg.norm(v)), CONE)
    expected = cones.directions(p, v, middle, np.eye(3)[[2, 0]])
    pattern, out = ray_pattern(36), np.empty(3)
    for k in range(36):
        kernel.ray_direction(frame, tangent, pattern, k, out)
        assert out == pytest.approx(expected[k], abs=1e-8)
        assert out @ frame[0] == pytest.approx(1.0)


@given(st.integers(0, 10_000))
def test_culling_by_the_sphere_never_loses_a_ray(seed):
    """Every ray that passes through the sphere survives both tests."""
    rng = np.random.default_rng(seed)
    sphere = np.append(rng.normal(0.0, 0.2, 3), rng.uniform(0.01, 0.2))
    pattern, d = ray_pattern(36), np.empty(3)
    for _ in range(40):
        p = rng.normal(0.0, 0.4, 3)
        v = sphere[:3] - p + rng.normal(0.0, 0.3, 3)
        v *= rng.uniform(0.03, 1.2) / np.linalg.norm(v)
        frame = frame_of(p, v, sphere[:3])
        tangent = kernel.cone_tangent(float(np.linalg.norm(v)), CONE)
        cone_passes = kernel.cone_can_meet(v, tangent, p, sphere)
        parts = frame @ (sphere[:3] - p)
        gap2 = ((sphere[:3] - p) ** 2).sum() - sphere[3] ** 2
        for k in range(36):
            kernel.ray_direction(frame, tangent, pattern, k, d)
            ray_passes = kernel.ray_can_meet(*parts, gap2, *(tangent * pattern[k]))
            along = max(0.0, d @ (sphere[:3] - p)) / (d @ d)
            gap = np.linalg.norm(p + along * d - sphere[:3]) - sphere[3]
            if gap < -1e-9:
                assert cone_passes
                assert ray_passes
            if gap > 1e-9:
                assert not ray_passes


# contact -----------------------------------------------------------------------------------------

REACH, LIMIT = 0.08, 2.0


def approach(model, coefficients, rotation=None, translation=(0.0, 0.0, 0.0)):
    out = np.empty(4)
    turn = np.eye(3) if rotation is None else rotation
    kernel.approach(
        *model.bvh, np.array([0, 0]), turn, np.array(translation), coefficients, REACH, LIMIT, out
    )
    return out


def box_distance(points, half):
    """Distance from points outside a box round the origin to it."""
    return np.linalg.norm(np.maximum(np.abs(points) - half, 0.0), axis=-1)


HALF = np.array([0.07, 0.16, 0.21]) / 2


def path(coefficients, s):
    s = np.asarray(s)[..., None]
    return coefficients[0] + s * coefficients[1] + s * s * coefficients[2]


def random_path(rng):
    """Return a path that begins further away than a contact."""
    while True:
        c = np.stack([rng.uniform(-0.5, 0.5, 3), rng.normal(0, 0.4, 3), rng.normal(0, 1.0, 3)])
        if box_distance(c[0], HALF) > REACH + 0.01:
            return c


def contact_cases(count):
    """Yield paths, and the first time at which each is within reach (None: never)."""
    rng = np.random.default_rng(0)
    times = np.arange(0.0, LIMIT, 5e-4)
    for _ in range(count):
        c = random_path(rng)
        away = box_distance(path(c, times), HALF)
        if abs(away.min() - REACH) < 1e-3:
            continue  # it grazes: within the tolerance either answer is right
        inside = np.flatnonzero(away <= REACH)
        yield c, times[inside[0]] if len(inside) else None


def test_contact_is_where_the_path_first_comes_near(shapes):
    found = 0
    for c, expected in contact_cases(1500):
        s, *point = approach(shapes[BOX], c)
        if math.isnan(s):
            continue  # the next test asks whether it may be
        found += 1
        assert expected is not None
        assert box_distance(path(c, s), HALF) == pytest.approx(REACH, abs=2e-4)
        before = box_distance(path(c, np.linspace(0.0, s, 400)), HALF)
        assert before.min() > REACH - 1e-6  # nothing earlier was stepped over
        assert s <= expected + 1e-9
        assert np.linalg.norm(path(c, s) - point) == pytest.approx(
            box_distance(path(c, s), HALF), rel=1e-9
        )
    assert found > 40


def test_no_contact_is_missed(shapes):
    """The path comes clearly nearer than the reach before the limit: there is a contact."""
    missed = total = 0
    for c, expected in contact_cases(1500):
        if expected is None:
            assert math.isnan(approach(shapes[BOX], c)[0])
            continue
        total += 1
        missed += math.isnan(approach(shapes[BOX], c)[0])
    assert total > 40
    assert missed == 0, f"{missed} of {total} contacts were reported as none"


def test_contact_from_within_reach_is_now(shapes):
    c = np.array([[0.0, 0.0, 0.105 + 0.05], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    s, *point = approach(shapes[BOX], c)
    assert s == 0.0
    assert point == pytest.approx([0.0, 0.0, 0.105])


@pytest.mark.parametrize(
    "velocity",
    [(0.0, 0.0, 0.0), (0.0, 0.0, 0.5), (0.0, 0.0, -0.05)],
    ids=["resting", "receding", "too slow for the horizon"],
)
def test_no_contact_without_an_approach(shapes, velocity):
    c = np.array([[0.0, 0.0, 0.6], velocity, [0.0, 0.0, 0.0]])
    assert math.isnan(approach(shapes[BOX], c)[0])


def test_contact_turns_with_the_object(shapes):
    rng = np.random.default_rng(3)
    c = np.array([[0.4, 0.3, 0.2], [-0.5, -0.4, -0.2], [0.0, 0.0, 0.1]])
    plain = approach(shapes[CAN], c)
    turn, shift = random_turn(rng), rng.uniform(-1, 1, 3)
    moved = np.stack([turn.apply(c[0]) + shift, turn.apply(c[1]), turn.apply(c[2])])
    there = approach(shapes[CAN], moved, turn.as_matrix(), shift)
    assert plain[0] > 0.0
    assert there == pytest.approx(plain, abs=1e-9)  # the point is in the frame of the mesh


def test_straight_approach_by_hand(shapes):
    c = np.array([[0.0, 0.0, 0.505], [0.0, 0.0, -0.4], [0.0, 0.0, 0.0]])
    s, *point = approach(shapes[BOX], c)
    assert s == pytest.approx((0.4 - REACH) / 0.4, abs=1e-3)
    assert point == pytest.approx([0.0, 0.0, 0.105])


def test_defaults_of_the_rays_are_those_of_the_specification():
    config = RayConfig()
    assert config.rays == cones.RAYS
    assert (config.slow_speed, config.fast_speed) == (cones.SLOW_SPEED, cones.FAST_SPEED)
    assert config.slow_angle == pytest.approx(cones.SLOW_ANGLE)
    assert config.fast_angle == pytest.approx(cones.FAST_ANGLE)
    assert (config.contact_distance, config.contact_horizon) == (REACH, LIMIT)


def test_surface_distance_of_the_box_model_is_that_of_the_formula(shapes):
    corners = shapes[BOX].vertices[shapes[BOX].faces]
    for point in np.random.default_rng(1).uniform(-0.4, 0.4, (20, 3)):
        if box_distance(point, HALF) > 0.0:
            assert meshes.nearest_surface(corners, point)[0] == pytest.approx(
                box_distance(point, HALF)
            )
