from dataclasses import replace

import numpy as np
import pytest

from igrip.lab.rendering.layout import look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.perception.registration.fit import PoseFit
from igrip.perception.registration.hand_motion import HandMotion, Holders, MovingHand, holds
from igrip.perception.registration.plane import Plane
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import shape_of
from igrip.perception.registration.view import depth_view

SOUP = "005_tomato_soup_can"
CAMERA = look_at(np.array([0.0, -0.6, 0.5]), np.zeros(3))


def view_with(points):
    """A depth picture of a table with a disc at each point of the table's frame, (n, 3)."""
    frame = RenderedScene({}, CAMERA).frame(0.0, np.random.default_rng(0))
    camera = points @ np.linalg.inv(CAMERA)[:3, :3].T + np.linalg.inv(CAMERA)[:3, 3]
    pixels = frame.intrinsics.pixels(camera)
    depth = frame.depth.copy()
    for (u, v), z in zip(np.round(pixels).astype(int), camera[:, 2], strict=True):
        depth[v - 3 : v + 4, u - 3 : u + 4] = z
    view = depth_view(replace(frame, depth=depth), [], Plane(CAMERA, 0.003, 0.5), 0.004)
    return view, pixels


def hand_at(middle):
    return np.asarray(middle) + np.random.default_rng(1).uniform(-0.04, 0.04, (21, 3))


def test_a_hand_that_moves_is_measured():
    motion = HandMotion()
    way = np.array([0.02, 0.01, 0.015])
    for k in range(4):
        view, pixels = view_with(hand_at([0.0, 0.0, 0.15]) + k * way)
        (hand,) = motion.update(view, [pixels], k / 10)
        assert hand.number == 0
        if k:
            np.testing.assert_allclose(hand.shift, way, atol=0.003)
            assert hand.speed == pytest.approx(10 * np.linalg.norm(way), rel=0.15)
        else:
            assert not hand.shift.any()


def test_two_hands_keep_their_numbers_when_they_are_listed_otherwise():
    motion = HandMotion()
    left, right = [-0.2, 0.0, 0.15], [0.2, 0.0, 0.15]
    view, pixels = view_with(np.concatenate([hand_at(left), hand_at(right)]))
    first = motion.update(view, [pixels[:21], pixels[21:]], 0.0)
    second = motion.update(view, [pixels[21:], pixels[:21]], 0.1)
    assert [hand.number for hand in first] == [0, 1]
    assert [hand.number for hand in second] == [1, 0]
    assert max(np.linalg.norm(hand.shift) for hand in second) < 1e-9


def test_a_hand_without_depth_is_none():
    view, pixels = view_with(hand_at([0.0, 0.0, 0.15]))
    empty = view._replace(depth=np.zeros_like(view.depth))
    assert HandMotion().update(empty, [pixels], 0.0) == []


@pytest.fixture
def can(ycb):
    shape = shape_of(ycb[SOUP])
    pose = RigidPose(np.eye(3), -shape.surface.centre)
    return PoseFit(shape, pose, None, 1.0, None)


def moving(points, number=0):
    return MovingHand(points, number, np.zeros(3), 0.0)


def test_a_hand_holds_what_it_is_at(can):
    beside = np.array([[0.05, 0.0, 0.0], [0.055, 0.0, 0.02], [0.15, 0.0, 0.0]])
    assert holds(moving(beside), can)
    assert not holds(moving(beside + [0.06, 0.0, 0.0]), can)


def test_a_hand_that_hides_a_thing_stays_its_own_until_it_is_seen(can):
    holders = Holders()
    near, far = np.zeros((21, 3)), np.full((21, 3), 0.3)
    assert holders.hand_at("can", can, True, [moving(far, 0), moving(near, 1)]).number == 1
    assert holders.hand_at("can", can, False, [moving(near, 0), moving(far, 1)]).number == 1
    assert holders.hand_at("can", can, True, [moving(near, 0), moving(far, 1)]).number == 0
    assert holders.hand_at("can", can, True, [moving(far, 0), moving(far, 1)]) is None
