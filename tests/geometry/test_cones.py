"""Cones, culling and contact of the compiled kernel, against plain numpy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.geometry import cones as cones_module
from igrip.geometry.cones import ray_pattern
from igrip.geometry.scene import RayConfig, Scene
from oracle import cones
from support import random_turn

ANGLES = Scene(RayConfig())._cones[1:5]
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
    assert math.atan(cones_module.cone_tangent(speed, *ANGLES)) == pytest.approx(
        cones.half_angle(speed)
    )


@given(st.floats(0.0, 2.0), st.floats(0.0, 2.0))
def test_a_faster_point_has_no_wider_cone(a, b):
    slow, fast = sorted((a, b))
    assert (
        cones_module.cone_tangent(slow, *ANGLES) >= cones_module.cone_tangent(fast, *ANGLES) - 1e-15
    )


def frame_of(p, v, middle, axes=None):
    frame = np.empty((3, 3))
    axes = np.eye(3) if axes is None else axes
    cones_module.cone_frame(p, v, np.append(middle, 1.0), axes, frame)
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
    tangent = cones_module.cone_tangent(float(np.linalg.norm(v)), *ANGLES)
    expected = cones.directions(p, v, middle, np.eye(3)[[2, 0]])
    pattern, out = ray_pattern(36), np.empty(3)
    for k in range(36):
        cones_module.ray_direction(frame, tangent, pattern, k, out)
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
        tangent = cones_module.cone_tangent(float(np.linalg.norm(v)), *ANGLES)
        cone_passes = cones_module.cone_can_meet(v, tangent, p, sphere)
        parts = frame @ (sphere[:3] - p)
        gap2 = ((sphere[:3] - p) ** 2).sum() - sphere[3] ** 2
        for k in range(36):
            cones_module.ray_direction(frame, tangent, pattern, k, d)
            ray_passes = cones_module.ray_can_meet(*parts, gap2, *(tangent * pattern[k]))
            along = max(0.0, d @ (sphere[:3] - p)) / (d @ d)
            gap = np.linalg.norm(p + along * d - sphere[:3]) - sphere[3]
            if gap < -1e-9:
                assert cone_passes
                assert ray_passes
            if gap > 1e-9:
                assert not ray_passes


def meets(v, tangent, p, sphere):
    """Whether a ray within the cone meets the sphere, by angles; None where culling may be lax.

    A sphere beside the apex and not ahead of it need not be culled.
    """
    away = sphere[:3] - p
    distance = np.linalg.norm(away)
    if distance <= sphere[3]:
        return True
    cosine = np.clip(away @ v / distance / np.linalg.norm(v), -1.0, 1.0)
    half_angle = math.atan(tangent)
    beyond = math.acos(cosine) - half_angle
    if beyond >= math.pi / 2:
        return False if -distance * math.cos(beyond) >= sphere[3] else None
    return distance * math.sin(max(0.0, beyond)) <= sphere[3]


@given(st.integers(0, 10_000))
def test_a_cone_is_culled_if_and_only_if_no_ray_in_it_can_meet_the_sphere(seed):
    rng = np.random.default_rng(seed)
    counts = {True: 0, False: 0, None: 0}
    for _ in range(200):
        sphere = np.append(rng.normal(0.0, 0.3, 3), rng.uniform(0.01, 0.3))
        p, v = rng.normal(0.0, 0.4, 3), rng.normal(0.0, 1.0, 3)
        tangent = rng.uniform(0.05, 1.5)
        wider, narrower = (
            meets(v, tangent, p, np.append(sphere[:3], sphere[3] * part)) for part in (1.001, 0.999)
        )
        if wider != narrower:
            continue  # at the border
        counts[wider] += 1
        if wider is not None:
            assert cones_module.cone_can_meet(v, tangent, p, sphere) == wider
    assert counts[True] > 10
    assert counts[False] > 10


@given(st.integers(0, 10_000), st.floats(0.01, 2.0))
def test_a_ray_is_culled_if_and_only_if_it_misses_the_sphere(seed, tangent):
    """From the sphere's place relative to the cone, as the kernel does it."""
    rng = np.random.default_rng(seed)
    pattern, d, counts = ray_pattern(36), np.empty(3), [0, 0]
    for _ in range(10):
        sphere = np.append(rng.normal(0.0, 0.2, 3), rng.uniform(0.01, 0.2))
        p, v = rng.normal(0.0, 0.3, 3), rng.normal(0.0, 1.0, 3)
        frame = frame_of(p, v, sphere[:3])
        parts = cones_module.sphere_from(frame, p, sphere)
        for k in range(36):
            cones_module.ray_direction(frame, tangent, pattern, k, d)
            along = max(0.0, d @ (sphere[:3] - p)) / (d @ d)
            gap = np.linalg.norm(p + along * d - sphere[:3]) - sphere[3]
            if abs(gap) > 1e-6:
                passes = cones_module.ray_can_meet(*parts, *(tangent * pattern[k]))
                assert passes == (gap < 0.0)
                counts[passes] += 1
    assert sum(counts) > 300
