"""Tagged objects: whose poses are told, kept, given up; and options that make no sense."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("cv2", reason="tags are drawn by OpenCV")
pytest.importorskip("pupil_apriltags", reason="tags are found by pupil-apriltags")

from igrip.errors import IgripError, UnknownModelError
from igrip.perception.poses import POSES
from igrip.rgbd import RgbdFrame
from support import BOX, CAN
from tag_pictures import CAMERA, draw, pose

TAG = {"model": BOX, "id": "box", "size": 0.05, "position": [0.035, 0.0, 0.02]}
TAG["orientation"] = Rotation.from_euler("y", 90, degrees=True).as_quat().tolist()
PLACE = np.eye(4)
PLACE[:3, :3] = Rotation.from_quat(TAG["orientation"]).as_matrix()
PLACE[:3, 3] = TAG["position"]
OBLIQUE = pose([0.02, 0.03, 0.4], [0.5, 0.3, 0.1])


@pytest.fixture
def estimator(shapes):
    return POSES.get("tags")(shapes, {"tags": {7: TAG}})


def frame_at(t, tag=OBLIQUE, world=None, depth=None):
    drawn = draw([(7, 0.05, tag)] if tag is not None else [], t=t, depth=depth)
    return RgbdFrame(t, drawn.colour, depth, CAMERA, world_from_camera=_or_eye(world))


def _or_eye(world):
    return np.eye(4) if world is None else world


def matrix(told):
    placed = np.eye(4)
    placed[:3, :3] = Rotation.from_quat(told.orientation).as_matrix()
    placed[:3, 3] = told.position
    return placed


def test_the_object_is_where_its_tag_says_in_the_world(estimator):
    world = np.eye(4)
    world[:3, :3] = Rotation.from_euler("xyz", [-2.0, 0.1, 0.5]).as_matrix()
    world[:3, 3] = [0.3, -0.4, 0.6]
    told = estimator.estimate(frame_at(1.25, world=world))["box"]
    np.testing.assert_allclose(matrix(told), world @ OBLIQUE @ np.linalg.inv(PLACE), atol=0.02)
    assert (told.model, told.t, told.source) == (BOX, 1.25, "tags")
    assert told.score > 0.99
    assert all(1e-5 < s < 5e-3 for s in told.std)


def test_what_was_never_seen_is_not_told(estimator):
    assert estimator.estimate(frame_at(0.0, None)) == {}


def test_a_hidden_object_keeps_its_pose_and_its_time(estimator):
    told = estimator.estimate(frame_at(0.0))["box"]
    assert estimator.estimate(frame_at(0.2, None))["box"] == told
    middle = CAMERA.pixels(OBLIQUE[None, :3, 3])
    hand = middle + np.random.default_rng(0).uniform(-20, 20, (21, 2))
    assert estimator.estimate(frame_at(5.0, None), [hand])["box"] == told
    near = np.full((400, 640), 0.25, np.float32)
    assert estimator.estimate(frame_at(6.0, None, depth=near))["box"] == told


def test_an_object_that_was_taken_away_is_gone_and_told_so_once(estimator):
    estimator.estimate(frame_at(0.0))
    assert estimator.estimate(frame_at(0.9, None))["box"] is not None
    assert estimator.estimate(frame_at(1.1, None)) == {"box": None}
    assert estimator.estimate(frame_at(1.2, None)) == {}
    assert estimator.estimate(frame_at(1.3))["box"].t == 1.3


def test_a_run_that_begins_anew_knows_nothing(estimator):
    estimator.estimate(frame_at(10.0))
    assert estimator.estimate(frame_at(0.0, None)) == {}


def test_only_the_models_that_are_asked_for(shapes):
    both = {7: TAG, 8: {**TAG, "model": CAN, "id": "can"}}
    estimator = POSES.get("tags")(shapes, {"tags": both, "models": [CAN]})
    assert estimator.estimate(frame_at(0.0)) == {}


def test_tags_from_a_file(shapes, tmp_path):
    lines = [f'[tags.7]\nmodel = "{BOX}"\nid = "box"\nsize = 0.05']
    lines += [f"position = {TAG['position']}", f"orientation = {TAG['orientation']}"]
    (tmp_path / "tags.toml").write_text("\n".join(lines))
    estimator = POSES.get("tags")(shapes, {"tags": str(tmp_path / "tags.toml")})
    told = estimator.estimate(frame_at(0.0))["box"]
    np.testing.assert_allclose(matrix(told), OBLIQUE @ np.linalg.inv(PLACE), atol=0.02)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({}, "needs to know which tags"),
        ({"tags": {7: {**TAG, "size": 0.0}}}, r"tags\.7\.size"),
        ({"tags": {7: {**TAG, "sizes": 0.1}}}, r"sizes"),
        ({"tags": {7: {**TAG, "orientation": [0, 0, 0, 2]}}}, "not a rotation"),
        ({"tags": {7: TAG, 8: {**TAG, "model": CAN}}}, "two models"),
        ({"tags": {7: TAG}, "family": "tag99"}, "tag36h11"),
        ({"tags": "/nowhere/tags.toml"}, "cannot be read"),
        ({"tags": {7: TAG}, "colour": 3}, "colour"),
    ],
)
def test_options_that_make_no_sense_are_refused(shapes, options, problem):
    with pytest.raises(IgripError, match=problem):
        POSES.get("tags")(shapes, options)


def test_a_model_that_the_catalogue_lacks_is_named(shapes):
    with pytest.raises(UnknownModelError, match="no model 'cup'"):
        POSES.get("tags")(shapes, {"tags": {7: {**TAG, "model": "cup"}}})
