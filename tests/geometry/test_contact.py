"""Contact: against paths sampled densely past a box, whose distance has a formula."""

from __future__ import annotations

import math

import numpy as np
import pytest

from igrip import load_objects
from igrip.geometry import contact
from igrip.geometry.packed_models import pack
from igrip.geometry.scene import RayConfig
from oracle import cones, meshes
from support import BOX, CAN, random_turn

REACH, LIMIT = 0.08, 2.0


def approach(model, coefficients, rotation=None, translation=(0.0, 0.0, 0.0)):
    turn = np.eye(3) if rotation is None else rotation
    models = pack({model.name: model}).arrays
    time, point = contact.approach(
        models, 0, turn, np.array(translation), coefficients, REACH, LIMIT
    )
    return [time, *(turn.T @ (np.array(point) - translation))]  # in the frame of the mesh


def box_distance(points, half):
    """Distance from points outside a box round the origin to it."""
    return np.linalg.norm(np.maximum(np.abs(points) - half, 0.0), axis=-1)


HALF = np.array([0.07, 0.16, 0.21]) / 2


def path(coefficients, s):
    s = np.asarray(s)[..., None]
    return coefficients[0] + s * coefficients[1] + s * s * coefficients[2]


def random_path(rng, bend):
    """Return a path that begins further away than a contact."""
    while True:
        c = np.stack([rng.uniform(-0.5, 0.5, 3), rng.normal(0, 0.4, 3), rng.normal(0, bend, 3)])
        if box_distance(c[0], HALF) > REACH + 0.01:
            return c


def contact_cases(count, bend=1.0):
    """Yield paths, and the first time at which each is within reach (None: never)."""
    rng = np.random.default_rng(0)
    times = np.arange(0.0, LIMIT, 5e-4)
    for _ in range(count):
        c = random_path(rng, bend)
        away = box_distance(path(c, times), HALF)
        if abs(away.min() - REACH) < 1e-3:
            continue  # it grazes: within the tolerance either answer is right
        inside = np.flatnonzero(away <= REACH)
        yield c, times[inside[0]] if len(inside) else None


@pytest.mark.parametrize("bend", [1.0, 6.0])
def test_contact_is_where_the_path_first_comes_near(shapes, bend):
    found = 0
    for c, expected in contact_cases(1500, bend):
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


@pytest.mark.parametrize("bend", [1.0, 6.0])
def test_no_contact_is_missed(shapes, bend):
    """The path comes clearly nearer than the reach before the limit: there is a contact."""
    missed = total = 0
    for c, expected in contact_cases(1500, bend):
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


@pytest.mark.parametrize("slope", [0.005, 0.02, 0.04, 0.06, 0.2])
def test_a_shallow_approach_is_found(slope):
    """Along a large flat thing conservative steps become ever shorter."""
    [model] = [load_objects("box:0.6x0.4x0.05")["box:0.6x0.4x0.05"]]
    gap, speed = 0.004, 0.3
    down = slope * speed
    top = 0.025 + REACH + gap
    c = np.array([[-0.25, 0.0, top], [speed, 0.0, -down], [0.0, 0.0, 0.0]])
    expected = gap / down
    s = approach(model, c)[0]
    if expected < 0.5 / speed:  # before the path has passed the far edge
        assert s == pytest.approx(expected, abs=0.02 if slope < 0.02 else 5e-3 + 1e-4 / down)
    else:
        assert math.isnan(s)


@pytest.mark.parametrize("speed", [0.4, 1.0, 3.0])
def test_no_short_crossing_of_a_corner_is_stepped_over(shapes, speed):
    """A straight path cuts 1 to 4 mm off the round corner of what is within reach."""
    rng = np.random.default_rng(11)
    for _ in range(300):
        depth, ahead = rng.uniform(0.001, 0.004), rng.uniform(0.15, 0.6)
        middle = np.array([HALF[0], HALF[1], 0.0])
        outwards, along = np.array([1.0, 1.0, 0.0]) / 2**0.5, np.array([1.0, -1.0, 0.0]) / 2**0.5
        start = middle + (REACH - depth) * outwards - ahead * along
        half_chord = math.sqrt(REACH**2 - (REACH - depth) ** 2)
        found = approach(shapes[BOX], np.array([start, speed * along, np.zeros(3)]))[0]
        entered = (ahead - half_chord) / speed
        left = (ahead + half_chord) / speed
        assert entered - 2e-3 <= found <= entered + 2.0 / contact.MAX_STEPS
        assert found < left


def test_defaults_of_the_rays_are_those_of_the_specification():
    config = RayConfig()
    assert config.rays_per_cone == cones.RAYS
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
