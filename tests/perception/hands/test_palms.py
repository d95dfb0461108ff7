"""A palm in the world against a plane that the camera sees, worked out on paper."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.perception.hands import HandDetection
from igrip.perception.hands._palms import PalmConfig, measure_palm
from igrip.rgbd import Intrinsics, RgbdFrame

CAMERA = Intrinsics(640, 400, 420.0, 421.0, 318.0, 203.0)
# a flat hand of 19 cm: wrist, then thumb and fingers from root to tip [m]
ROOTS = np.array([[-0.035, 0.03], [-0.03, 0.09], [-0.01, 0.095], [0.01, 0.092], [0.028, 0.085]])
FLAT = np.vstack([[[0.0, 0.0]], *[root * (1.0 + 0.3 * np.arange(4)[:, None]) for root in ROOTS]])


def scene(place, turn, background=1.2, world=None):
    """Return a frame in which a large plane holds the hand, its landmarks, and its true palm."""
    rotation = Rotation.from_euler("xyz", turn).as_matrix()
    points = np.column_stack([FLAT, np.zeros(21)]) @ rotation.T + place
    normal = rotation[:, 2]
    us, vs = np.meshgrid(np.arange(640.0), np.arange(400.0))
    rays = np.stack(
        [(us - CAMERA.cx) / CAMERA.fx, (vs - CAMERA.cy) / CAMERA.fy, np.ones_like(us)], axis=-1
    )
    on_plane = (normal @ place) / (rays @ normal)
    on_hand = rays * on_plane[..., None]
    local = (on_hand - place) @ rotation
    palm = (np.abs(local[..., 0]) < 0.042) & (local[..., 1] > -0.01) & (local[..., 1] < 0.11)
    depth = np.where(palm & (on_plane > 0), on_plane, background).astype(np.float32)
    frame = RgbdFrame(
        1.5, np.zeros((400, 640, 3), np.uint8), depth, CAMERA,
        world_from_camera=np.eye(4) if world is None else world,
    )  # fmt: skip
    return (
        frame,
        HandDetection(CAMERA.pixels(points), 0.9, "right"),
        points[[0, 5, 17]].mean(axis=0),
    )


turns = st.tuples(*[st.floats(-0.7, 0.7)] * 2, st.floats(-3.0, 3.0))
places = st.tuples(st.floats(-0.15, 0.15), st.floats(-0.1, 0.1), st.floats(0.45, 0.9))


@given(place=places, turn=turns)
def test_the_palm_of_a_tilted_hand_is_found_where_it_is(place, turn):
    frame, hand, palm = scene(np.array(place), turn)
    found = measure_palm(hand, frame)
    assert found is not None
    np.testing.assert_allclose(found.position, palm, atol=2e-3)
    assert found.t == 1.5
    assert found.source == "camera"


@given(place=places, turn=turns, seed=st.integers(0, 99))
def test_holes_and_background_seen_through_the_hand_do_not_move_it(place, turn, seed):
    frame, hand, palm = scene(np.array(place), turn)
    rng = np.random.default_rng(seed)
    chance = rng.random(frame.depth.shape)
    frame.depth[chance < 0.3] = 0.0
    frame.depth[chance > 0.85] = 1.2
    found = measure_palm(hand, frame)
    assert found is not None
    np.testing.assert_allclose(found.position, palm, atol=8e-3)


def test_std_is_what_the_error_is():
    rng = np.random.default_rng(3)
    ratios = []
    for _ in range(200):
        turn = rng.uniform(-0.5, 0.5, 3)
        frame, hand, palm = scene(rng.uniform([-0.1, -0.1, 0.5], [0.1, 0.1, 0.9]), turn)
        # depth noise that is alike over 6 pixels, as of a stereo camera; jitter of the finder
        coarse = rng.normal(0.0, 0.006, (67, 107))
        frame.depth[:] += np.kron(coarse, np.ones((6, 6)))[:400, :640].astype(np.float32)
        unit = np.linalg.norm(hand.landmarks[0] - hand.landmarks[5])
        moved = hand._replace(landmarks=hand.landmarks + rng.normal(0.0, 0.02 * unit, 2))
        found = measure_palm(moved, frame)
        ratios.append((np.array(found.position) - palm) / found.std)
    assert 0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.5
    assert np.mean(np.abs(ratios) < 3.0) > 0.97


def test_std_turns_with_the_world():
    plain, hand, _ = scene(np.array([0.0, 0.0, 0.6]), (0.2, 0.1, 0.0))
    world = np.eye(4)
    world[:3, :3] = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    world[:3, 3] = [1.0, 2.0, 3.0]
    turned, hand, _ = scene(np.array([0.0, 0.0, 0.6]), (0.2, 0.1, 0.0), world=world)
    a, b = measure_palm(hand, plain), measure_palm(hand, turned)
    x, y, z = a.position
    np.testing.assert_allclose(b.position, [1.0 + x, 2.0 - z, 3.0 + y], atol=1e-9)
    np.testing.assert_allclose(b.std, [a.std[0], a.std[2], a.std[1]], rtol=1e-6)


def test_without_depth_there_is_no_palm():
    frame, hand, _ = scene(np.array([0.0, 0.0, 0.6]), (0.0, 0.0, 0.0))
    colour_only = RgbdFrame(frame.t, frame.colour, None, CAMERA)
    assert measure_palm(hand, colour_only) is None
    frame.depth[:] = 0.0
    assert measure_palm(hand, frame) is None
    frame.depth[:] = np.nan
    assert measure_palm(hand, frame) is None


def test_a_triangle_over_something_far_is_no_palm():
    frame, hand, _ = scene(np.array([0.0, 0.0, 0.6]), (0.0, 0.0, 0.0))
    frame.depth[:] = 3.0
    assert measure_palm(hand, frame) is None


@pytest.mark.parametrize("where", [np.nan, 1e12, -500.0, 5000.0])
def test_landmarks_outside_the_picture_are_no_palm(where):
    frame, hand, _ = scene(np.array([0.0, 0.0, 0.6]), (0.0, 0.0, 0.0))
    assert measure_palm(hand._replace(landmarks=hand.landmarks * 0.0 + where), frame) is None


def test_all_landmarks_where_all_have_depth():
    place = np.array([0.0, 0.0, 0.6])
    frame, hand, _ = scene(place, (0.0, 0.0, 0.0))
    config = PalmConfig(landmarks=True)
    assert measure_palm(hand, frame, config).landmarks is None  # the fingertips have none
    frame.depth[:] = 0.6
    found = measure_palm(hand, frame, config)
    expected = np.column_stack([FLAT, np.zeros(21)]) + place
    np.testing.assert_allclose(found.landmarks, expected, atol=1e-6)
