"""Tags drawn by a homography that is known: corners, both poses, and which is believed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

pytest.importorskip("cv2", reason="tags are drawn by OpenCV")
pytest.importorskip("pupil_apriltags", reason="tags are found by pupil-apriltags")

from igrip.perception.tag_detector import TagDetection, TagDetector
from igrip.perception.tag_pose import TagPlacement, angle_between, choose_pose, tag_poses
from tag_pictures import CAMERA, draw, pose

SIZE = 0.05
ALONE = {7: TagPlacement(SIZE, np.eye(4))}


@pytest.fixture(scope="module")
def detector():
    return TagDetector()


def true_pixels(place, camera_from_thing):
    points = place.corners @ camera_from_thing[:3, :3].T + camera_from_thing[:3, 3]
    return CAMERA.pixels(points)


def tilted(tilt, around, spin, at):
    """Return a tag's pose, tilted round an axis in the picture and spun in its own plane."""
    placed = pose(at, tilt * np.array([np.cos(around), np.sin(around), 0.0]))
    placed[:3, :3] = placed[:3, :3] @ Rotation.from_euler("z", spin).as_matrix()
    return placed


@settings(max_examples=12)
@given(
    tilt=st.floats(0, 1.1), around=st.floats(0, 6.28), spin=st.floats(-3.1, 3.1),
    z=st.floats(0.3, 0.6), blur=st.floats(0.0, 1.2), seed=st.integers(0, 99),
)  # fmt: skip
def test_corners_and_pose_are_those_drawn(detector, tilt, around, spin, z, blur, seed):
    true = tilted(tilt, around, spin, [0.05 * z, -0.04 * z, z])
    tags = detector.detect(draw([(7, SIZE, true)], blur=blur, seed=seed))
    assert [tag.id for tag in tags] == [7]
    np.testing.assert_allclose(tags[0].corners, true_pixels(ALONE[7], true), atol=0.6)
    poses = tag_poses(tags, ALONE, CAMERA)
    chosen = choose_pose(poses)
    if chosen is None:
        chosen = choose_pose(poses, before=true)
    fit, probability = chosen
    assert probability > 0.99
    assert angle_between(fit.camera_from_object, true) < np.radians(8.5)
    off = fit.camera_from_object[:3, 3] - true[:3, 3]
    assert np.linalg.norm(off) < 0.006
    assert (np.abs(off) < 5.0 * np.sqrt(np.diag(fit.covariance)) + 1e-4).all()


def noisy(rng, true, noise, places=ALONE):
    return [
        TagDetection(number, true_pixels(place, true) + rng.normal(0.0, noise, (4, 2)))
        for number, place in places.items()
    ]


def test_a_small_tag_is_undecided_rather_than_flipped():
    rng = np.random.default_rng(5)
    decided = flipped = 0
    for _ in range(300):
        tilt, around = rng.uniform(0.2, 1.0), rng.uniform(0, 6.28)
        true = tilted(tilt, around, rng.uniform(-3, 3), [0.0, 0.0, rng.uniform(0.3, 2.0)])
        chosen = choose_pose(tag_poses(noisy(rng, true, 0.2), ALONE, CAMERA))
        if chosen is not None:
            decided += 1
            flipped += angle_between(chosen[0].camera_from_object, true) > np.radians(20)
    assert decided > 50
    assert flipped <= 1


def test_what_was_there_before_and_what_stands_upright_decide():
    rng = np.random.default_rng(6)
    undecided = 0
    for _ in range(60):
        true = tilted(0.6, rng.uniform(0, 6.28), rng.uniform(-3, 3), [0.0, 0.0, 1.8])
        poses = tag_poses(noisy(rng, true, 0.2), ALONE, CAMERA)
        if choose_pose(poses) is not None:
            continue
        undecided += 1
        assert angle_between(
            choose_pose(poses, before=true)[0].camera_from_object, true
        ) < np.radians(20)
        up = np.array([0.0, 0.0, 1.0]), true[:3, 2]
        assert angle_between(choose_pose(poses, up=up)[0].camera_from_object, true) < np.radians(20)
    assert undecided > 20


def test_what_was_before_cannot_vouch_for_what_the_picture_contradicts():
    rng = np.random.default_rng(7)
    true = tilted(0.7, 0.3, 0.0, [0.0, 0.0, 0.3])
    poses = tag_poses(noisy(rng, true, 0.1), ALONE, CAMERA)
    wrong = tilted(-0.7, 0.3, 0.0, [0.0, 0.0, 0.3])
    chosen = choose_pose(poses, before=wrong)
    assert chosen is None or angle_between(chosen[0].camera_from_object, true) < np.radians(10)


def test_tags_on_two_sides_leave_no_doubt():
    rng = np.random.default_rng(8)
    side = np.eye(4)
    side[:3, :3] = Rotation.from_euler("y", 70, degrees=True).as_matrix()
    side[:3, 3] = [0.04, 0.0, -0.03]
    places = {7: TagPlacement(SIZE, np.eye(4)), 8: TagPlacement(SIZE, side)}
    for _ in range(40):
        true = pose([0.0, 0.0, rng.uniform(0.6, 1.2)], [rng.uniform(-0.4, 0.4), 0.55, 0.0])
        chosen = choose_pose(tag_poses(noisy(rng, true, 0.2, places), places, CAMERA))
        assert chosen is not None
        assert angle_between(chosen[0].camera_from_object, true) < np.radians(6)


def test_std_is_what_the_error_is_and_grows_with_distance():
    rng = np.random.default_rng(9)
    spread = []
    for z in (0.4, 0.8):
        true = tilted(0.6, 0.4, 0.2, [0.02, 0.01, z])
        ratios, stds = [], []
        for _ in range(150):
            fit, _ = choose_pose(tag_poses(noisy(rng, true, 0.2), ALONE, CAMERA), before=true)
            stds.append(np.sqrt(np.diag(fit.covariance)))
            ratios.append((fit.camera_from_object[:3, 3] - true[:3, 3]) / stds[-1])
        assert 0.6 < np.sqrt(np.mean(np.square(ratios))) < 1.4
        spread.append(np.mean(stds, axis=0))
    assert 3.0 < spread[1][2] / spread[0][2] < 6.0  # depth: with the square


@pytest.mark.parametrize("corners", [np.zeros((4, 2)), np.full((4, 2), np.nan)])
def test_corners_that_are_no_square_give_no_pose(corners):
    assert choose_pose(tag_poses([TagDetection(7, corners)], ALONE, CAMERA)) is None
    assert tag_poses([], ALONE, CAMERA) == []
