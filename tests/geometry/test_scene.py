"""Hands against objects: invariances, counts, drawing, and what happens without either."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.geometry.scene import RayConfig, Scene
from igrip.motion.reach_detection import ReachDetector
from igrip.motion.trajectory import Motion
from oracle import cones, meshes, motion
from support import BOX, CAN, oracle_mesh, placed, random_turn

ARRAYS = (
    "vertex", "surface", "future_vertex", "future_surface", "centre", "centre_rate", "axial",
    "half_length",
)  # fmt: skip


def moving(coefficients, position=None):
    """Return the motion of a polynomial."""
    future, velocity = motion.future(coefficients, 10, 0.3)
    c1 = coefficients[1]
    return Motion(
        t=0.0,
        position=coefficients[0] if position is None else position,
        coefficients=coefficients,
        velocity=c1,
        speed=float(np.linalg.norm(c1)),
        window_peak_speed=None,
        future=future,
        future_velocity=velocity,
        reach=ReachDetector().update(0.0, (0.0, 0.0, 0.0)),
    )


def towards(rng, target, speed=None):
    start = target + rng.normal(0.0, 0.2, 3)
    c1 = 1.5 * (target - start) + rng.normal(0.0, 0.05, 3)
    c1 = c1 if speed is None else c1 * speed / np.linalg.norm(c1)
    return moving(np.stack([start, c1, rng.normal(0.0, 0.3, 3)]))


def some_objects(rng, shapes, count=4):
    return [
        placed(
            shapes[(BOX, CAN)[k % 2]], f"o{k}", random_turn(rng).as_matrix(),
            rng.uniform(-0.4, 0.4, 3), rng.normal(0.0, 0.1, 3) * (k == 1),
        )
        for k in range(count)
    ]  # fmt: skip


def assert_same(a, b, tolerance=1e-9):
    assert a.hits.tolist() == b.hits.tolist()
    for name in ARRAYS:
        assert getattr(a, name) == pytest.approx(getattr(b, name), abs=tolerance), name
    assert a.spread == pytest.approx(b.spread, abs=tolerance, nan_ok=True)


@given(st.integers(0, 10_000))
def test_a_rigid_motion_of_everything_changes_nothing(shapes, seed):
    rng = np.random.default_rng(seed)
    objects = some_objects(rng, shapes)
    hands = [towards(rng, objects[k].centre) for k in range(2)]
    turn, shift = random_turn(rng), rng.uniform(-2.0, 2.0, 3)
    moved_objects = [
        placed(
            o.model, o.id, turn.as_matrix() @ o.rotation,
            turn.apply(o.translation) + shift, turn.apply(o.velocity),
        )
        for o in objects
    ]  # fmt: skip
    moved_hands = [
        moving(turn.apply(hand.coefficients) + [shift, np.zeros(3), np.zeros(3)]) for hand in hands
    ]
    scene = Scene(RayConfig())
    for a, b in zip(
        scene.measure(hands, objects), scene.measure(moved_hands, moved_objects), strict=True
    ):
        assert_same(a, b)


@given(st.integers(0, 10_000))
def test_each_pair_is_measured_as_if_it_were_alone(shapes, seed):
    rng = np.random.default_rng(seed)
    objects = some_objects(rng, shapes)
    hands = [towards(rng, objects[k].centre) for k in range(3)]
    together = Scene(RayConfig()).measure(hands, objects)
    for hand, whole in zip(hands, together, strict=True):
        for k, single in enumerate(objects):
            [alone] = Scene(RayConfig()).measure([hand], [single])
            assert alone.hits[0] == whole.hits[k]
            for name in ARRAYS:
                assert getattr(alone, name)[0] == getattr(whole, name)[k], name


def test_order_of_objects_and_hands(shapes):
    rng = np.random.default_rng(7)
    objects = some_objects(rng, shapes, 6)
    hands = [towards(rng, objects[k].centre) for k in range(2)]
    scene = Scene(RayConfig())
    straight = scene.measure(hands, objects)
    order = rng.permutation(6)
    other = Scene(RayConfig()).measure(hands[::-1], [objects[k] for k in order])[::-1]
    for a, b in zip(straight, other, strict=True):
        assert (a.hits[order] == b.hits).all()
        assert a.spread == b.spread
        for name in ARRAYS:
            assert (getattr(a, name)[order] == getattr(b, name)).all(), name


def test_a_model_that_appears_later_changes_nothing_for_the_others(shapes):
    rng = np.random.default_rng(8)
    objects = some_objects(rng, shapes, 2)
    hand = towards(rng, objects[0].centre)
    scene = Scene(RayConfig())
    [before] = scene.measure([hand], objects[:1])
    [after] = scene.measure([hand], objects)
    assert before.hits[0] == after.hits[0]
    assert before.vertex[0] == after.vertex[0]
    [again] = scene.measure([hand], objects[:1])
    assert_same(before, again, tolerance=0.0)


def test_objects_do_not_hide_one_another(shapes):
    # the nearer box is wider in every direction: occlusion would leave nothing for the can
    front = placed(shapes[BOX], "front", translation=(0.3, 0.0, 0.0))
    back = placed(shapes[CAN], "back", translation=(0.6, 0.0, 0.0))
    hand = moving(np.array([[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    [both] = Scene(RayConfig()).measure([hand], [front, back])
    [alone] = Scene(RayConfig()).measure([hand], [back])
    assert both.hits[1] == alone.hits[0] > 0


@pytest.mark.parametrize("speed", [0.0, 0.0299])
def test_a_resting_hand_casts_no_rays(shapes, speed):
    body = placed(shapes[BOX], translation=(0.3, 0.0, 0.0))
    hand = moving(np.array([[0.0, 0.0, 0.0], [speed, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    scene = Scene(RayConfig())
    [geometry] = scene.measure([hand], [body])
    assert geometry.hits.tolist() == [0]
    assert scene.counters[2] == 0
    assert geometry.surface[0] == pytest.approx(0.265)


def test_counters_count_the_rays_cast(shapes):
    scene = Scene(RayConfig(rays_per_cone=20))
    objects = [placed(shapes[BOX], translation=(0.3, 0.0, 0.0)), placed(shapes[CAN])]
    hand = moving(np.array([[0.5, 0.4, 0.0], [0.4, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    scene.measure([hand, hand], objects)
    assert scene.counters[2] == 2 * 2 * 10 * 20


def test_velocity_of_the_object_counts_in_the_derivative(shapes):
    hand = moving(np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    rates = []
    for velocity in ((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (-0.2, 0.0, 0.0), (0.0, 5.0, 0.0)):
        body = placed(shapes[CAN], translation=(0.4, 0.0, 0.0), velocity=velocity)
        [geometry] = Scene(RayConfig()).measure([hand], [body])
        rates.append(geometry.centre_rate[0])
    assert rates == pytest.approx([-0.3, 0.0, -0.5, -0.3], abs=1e-9)


def test_a_hand_at_the_very_centre_has_a_finite_derivative(shapes):
    body = placed(shapes[CAN])
    hand = moving(np.stack([body.centre, [0.3, 0.0, 0.0], np.zeros(3)]))
    [geometry] = Scene(RayConfig()).measure([hand], [body])
    assert np.isfinite(geometry.centre_rate).all()


def test_nothing_to_measure(shapes):
    scene = Scene(RayConfig())
    hand = moving(np.zeros((3, 3)))
    assert scene.measure([], [placed(shapes[BOX])]) == []
    [geometry] = scene.measure([hand], [])
    assert len(geometry.objects) == len(geometry.hits) == len(geometry.vertex) == 0
    assert math.isnan(geometry.spread)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_spread_is_the_largest_distance_between_centres(shapes, count):
    rng = np.random.default_rng(count)
    objects = some_objects(rng, shapes, count)
    [geometry] = Scene(RayConfig()).measure([towards(rng, objects[0].centre)], objects)
    gaps = [np.linalg.norm(a.centre - b.centre) for a in objects for b in objects]
    if count == 1:
        assert math.isnan(geometry.spread)
    else:
        assert geometry.spread == pytest.approx(max(gaps), rel=1e-12)


def test_the_rays_that_are_drawn_are_the_rays_that_are_counted(shapes):
    rng = np.random.default_rng(11)
    scene = Scene(RayConfig())
    for body in some_objects(rng, shapes, 6):
        hand = towards(rng, body.centre)
        [geometry] = scene.measure([hand], [body])
        directions, lengths = scene.impacts(hand, body)
        assert directions.shape == (10, 36, 3)
        assert np.isfinite(lengths).sum() == geometry.hits[0]
        corners = oracle_mesh(body.model).corners
        for k in (0, 4, 9):
            apex = (hand.future[k] - body.translation) @ body.rotation
            turned = directions[k] @ body.rotation
            expected = meshes.ray_lengths(corners, apex, turned)
            assert lengths[k] == pytest.approx(expected, rel=1e-7)
            axis = hand.future_velocity[k] / np.linalg.norm(hand.future_velocity[k])
            assert directions[k, 0] == pytest.approx(axis, abs=1e-12)


def test_points_without_a_cone_are_drawn_as_nan(shapes):
    body = placed(shapes[BOX], translation=(0.3, 0.0, 0.0))
    stops = np.array([[0.0, 0.0, 0.0], [0.31, 0.0, 0.0], [-0.5, 0.0, 0.0]])  # at rest at last
    directions, lengths = Scene(RayConfig()).impacts(moving(stops), body)
    slow = np.abs(0.31 - np.arange(1, 11) * 0.03) < 0.03
    assert (np.isnan(directions).all(axis=(1, 2)) == slow).all()
    assert np.isinf(lengths[slow]).all()


def test_contact_in_the_world(shapes):
    turn, shift = random_turn(np.random.default_rng(2)), np.array([0.2, -0.4, 1.0])
    body = placed(shapes[BOX], "box", turn.as_matrix(), shift)
    along = turn.apply([0.0, 0.0, 1.0])
    hand = moving(np.stack([shift + 0.505 * along, -0.4 * along, np.zeros(3)]))
    seconds, point = Scene(RayConfig()).contact(hand, body)
    assert seconds == pytest.approx(0.8, abs=1e-3)
    assert point == pytest.approx(tuple(shift + 0.105 * along))
    away = moving(np.stack([shift + 0.505 * along, 0.4 * along, np.zeros(3)]))
    assert Scene(RayConfig()).contact(away, body) is None


@pytest.mark.parametrize("rays", [1, 7])
def test_other_numbers_of_rays(shapes, rays):
    rng = np.random.default_rng(rays)
    body = some_objects(rng, shapes, 1)[0]
    hand = towards(rng, body.centre)
    [geometry] = Scene(RayConfig(rays_per_cone=rays)).measure([hand], [body])
    mesh, axes = oracle_mesh(body.model), body.model.mesh_from_object[:3, :3].T
    expected = 0
    for point, velocity in zip(hand.future, hand.future_velocity, strict=True):
        apex, turned = (point - body.translation) @ body.rotation, velocity @ body.rotation
        fan = cones.directions(apex, turned, mesh.middle, axes[[2, 0]], rays)
        expected += int((meshes.ray_margins(mesh.corners, apex, fan) >= 0.0).sum())
    assert geometry.hits[0] == expected


def rays_that_meet(corners, origins, directions):
    """Return how many rays meet a mesh, every ray against every triangle (Möller & Trumbore)."""
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    met = 0
    for p, d in zip(origins, directions, strict=True):
        q = np.cross(d, e2)
        determinant = (e1 * q).sum(axis=1)
        with np.errstate(all="ignore"):
            u = ((p - a) * q).sum(axis=1) / determinant
            r = np.cross(p - a, e1)
            v, t = (r @ d) / determinant, (e2 * r).sum(axis=1) / determinant
        hits = (determinant != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t >= 0.0)
        met += bool(hits.any())
    return met


@pytest.mark.parametrize("model", [BOX, CAN])
@pytest.mark.parametrize("seed", range(6))
def test_hits_and_distances_are_those_of_every_ray_against_every_triangle(shapes, model, seed):
    """Whatever the trees, the bounding spheres and the spheres inside leave out."""
    rng = np.random.default_rng(seed)
    body = placed(
        shapes[model], rotation=random_turn(rng).as_matrix(), translation=rng.normal(0, 0.2, 3)
    )
    hand = towards(rng, body.centre, speed=(0.1, 0.5, 2.0)[seed % 3])
    scene = Scene(RayConfig(rays_per_cone=9))
    [geometry] = scene.measure([hand], [body])
    directions, lengths = scene.impacts(hand, body)
    corners = (shapes[model].vertices @ body.rotation.T + body.translation)[shapes[model].faces]
    origins = np.repeat(hand.future, 9, axis=0)
    rays = directions.reshape(-1, 3)
    known = np.isfinite(rays).all(axis=1)
    assert geometry.hits[0] == rays_that_meet(corners, origins[known], rays[known])
    assert geometry.hits[0] == np.isfinite(lengths).sum()
    vertices = corners.reshape(-1, 3)
    for point, distance in ((hand.position, "vertex"), (hand.future.mean(axis=0), "future_vertex")):
        nearest = np.linalg.norm(vertices - point, axis=1).min()
        assert getattr(geometry, distance)[0] == pytest.approx(nearest, rel=1e-12)


def test_without_a_minimal_speed_a_point_at_rest_still_has_no_cone(shapes):
    body = placed(shapes[BOX], translation=(0.3, 0.0, 0.0))
    hand = moving(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    scene = Scene(RayConfig(min_speed=0.0))
    [geometry] = scene.measure([hand], [body])
    assert geometry.hits.tolist() == [0]
    assert scene.counters[2] == 0
    directions, lengths = scene.impacts(hand, body)
    assert np.isnan(directions).all()
    assert np.isinf(lengths).all()


@pytest.mark.parametrize(("speed", "cones"), [(0.03, 10), (0.0299, 0)])
def test_a_point_at_the_minimal_speed_has_a_cone(shapes, speed, cones):
    scene = Scene(RayConfig())
    hand = moving(np.array([[0.0, 0.0, 0.0], [speed, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    scene.measure([hand], [placed(shapes[BOX], translation=(0.3, 0.0, 0.0))])
    assert scene.counters[2] == 36 * cones


def test_without_objects_every_array_is_empty():
    hand = moving(np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    [geometry] = Scene(RayConfig()).measure([hand], [])
    for name in ("hits", *ARRAYS):
        assert getattr(geometry, name).shape == (0,), name
    assert math.isnan(geometry.spread)
    assert geometry.cylinders().centre.shape == (0, 3)
