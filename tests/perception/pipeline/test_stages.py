"""Stages made for each camera: palms measured, ids shared or kept apart."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.entities import ObjectPose
from igrip.errors import IgripError, UnknownNameError
from igrip.perception.hand_ids import HandIdConfig
from igrip.perception.hands import HandDetection
from igrip.perception.pipeline.merge import DetectedHands
from igrip.perception.pipeline.stages import (
    CrossCameraVisibility,
    HandIds,
    HandStage,
    ObjectStage,
    hand_stages,
    object_stages,
)
from igrip.rgbd import Intrinsics, RgbdFrame

CAMERA = Intrinsics(320, 240, 250.0, 250.0, 159.5, 119.5)
HAND = np.array([[0.0, 40.0]] + [[-20.0 + 2 * k, -20.0 + k] for k in range(20)])
HAND[5], HAND[17] = (-20.0, -20.0), (20.0, -20.0)


def frame(t, camera="a", depth=0.6, shift=0.0):
    picture = np.zeros((240, 320, 3), np.uint8)
    measured = None if depth is None else np.full((240, 320), depth, np.float32)
    pose = np.eye(4)
    pose[0, 3] = shift
    return RgbdFrame(t, picture, measured, CAMERA, camera, pose)


class Detector:
    """Sees hands where it is told to, in whatever order."""

    def __init__(self, *centres, labels=("right", "left")):
        self.centres, self.labels = centres, labels

    def detect(self, frame):
        return [
            HandDetection(HAND + centre, 0.9, label)
            for centre, label in zip(self.centres, self.labels, strict=False)
        ]

    def close(self):
        pass


def new_ids(shared=False):
    return HandIds(HandIdConfig(), shared)


def run(stage, frames):
    found = None
    for one in frames:
        found = stage(one)
    return found


def test_a_hand_is_measured_in_the_world_once_it_was_seen_for_a_while():
    stage = HandStage(Detector([100.0, 100.0]), new_ids())
    assert not stage(frame(0.0, shift=1.0)).hands
    found = run(stage, [frame(k / 30, shift=1.0) for k in range(1, 6)])
    palm = (HAND[[0, 5, 17]].mean(axis=0) + 100.0 - [159.5, 119.5]) * 0.6 / 250.0
    assert found.hands["right"].position == pytest.approx((1.0 + palm[0], palm[1], 0.6), abs=2e-3)
    assert found.hands["right"].t == pytest.approx(5 / 30)
    assert found.landmarks["right"] == pytest.approx(HAND + 100.0)


def test_a_hand_without_depth_is_not_measured():
    stage = HandStage(Detector([100.0, 100.0]), new_ids())
    run(stage, [frame(k / 30) for k in range(5)])
    found = stage(frame(0.2, depth=None))
    assert found.hands == {"right": None}
    assert not found.landmarks


def test_two_cameras_that_see_one_hand_call_it_the_same():
    """The second stands 0.2 m to the right, and sees the hand further to the left."""
    shared, places = new_ids(shared=True), {"a": 0.0, "b": 0.2}
    stages = {
        "a": HandStage(Detector([160.0, 100.0]), shared),
        "b": HandStage(Detector([160.0 - 0.2 * 250 / 0.6, 100.0], labels=("left",)), shared),
    }
    told = []
    for k in range(12):
        camera = "ab"[k % 2]
        found = stages[camera](frame(k / 60, camera, shift=places[camera]))
        told += [(id, hand.position) for id, hand in found.hands.items() if hand]
    assert {id for id, _ in told} == {"right"}
    spread = np.ptp([place for _, place in told], axis=0)
    assert spread.max() < 1e-3


def test_kept_apart_each_camera_names_its_own():
    stages = [HandStage(Detector([160.0, 100.0]), new_ids(), separate=True) for _ in range(2)]
    found = [
        run(stage, [frame(k / 30, camera) for k in range(5)])
        for stage, camera in zip(stages, "ab", strict=True)
    ]
    assert [list(f.hands) for f in found] == [["a/right"], ["b/right"]]


def test_a_camera_that_misses_a_hand_takes_nothing_from_one_that_sees_it():
    shared = new_ids(shared=True)
    sees, misses = HandStage(Detector([160.0, 100.0]), shared), HandStage(Detector(), shared)
    for k in range(10):
        assert None not in sees(frame(k / 30, "a")).hands.values()
        assert not misses(frame(k / 30 + 0.01, "b")).hands


def test_a_recording_that_begins_anew_is_another_run():
    shared = new_ids(shared=True)
    for begin in (100.0, 0.0):
        stage = HandStage(Detector([160.0, 100.0]), shared)
        found = [stage(frame(begin + k / 30)) for k in range(10)]
        assert [len(f.hands) for f in found] == [0, 0, *[1] * 8]


def test_what_is_wrong_is_said_before_the_camera_runs(ycb):
    with pytest.raises(UnknownNameError, match="mediapipe"):
        hand_stages("mediapip", 2)
    with pytest.raises(UnknownNameError, match="depth"):
        object_stages("deep", ycb, {})
    with pytest.raises(IgripError, match="colour"):
        object_stages("depth", ycb, {"models": ["006_mustard_bottle"], "colour": 1})


POSE = ObjectPose(position=(0.0, 0.0, 1.0), orientation=(0.0, 0.0, 0.0, 1.0), model="box")


class Things:
    """Finds what it is told to, and notes what covered it."""

    def __init__(self, found):
        self.found, self.covers = found, []

    def estimate(self, frame, hands=()):
        self.covers.append(len(hands))
        return self.found

    def close(self):
        pass


def test_a_camera_that_misses_an_object_takes_nothing_from_one_that_sees_it():
    visibility = CrossCameraVisibility()
    sees = ObjectStage(Things({"box": POSE}), visibility)
    misses = ObjectStage(Things({"box": None}), visibility)
    assert sees(frame(1.0, "a"), None).poses == {"box": POSE}
    assert misses(frame(1.1, "b"), None).poses == {}
    assert misses(frame(2.5, "b"), None).poses == {"box": None}  # nobody saw it since
    sees(frame(3.0, "a"), None)
    gone = ObjectStage(Things({"box": None}), visibility)
    assert gone(frame(3.1, "a"), None).poses == {"box": None}  # who saw it last, misses it


def test_every_hand_that_is_seen_covers_what_is_behind_it_but_not_for_long():
    things = Things({})
    stage = ObjectStage(things, CrossCameraVisibility())
    seen = DetectedHands(frame(1.0, depth=None), {}, {}, [HAND, HAND])
    stage(frame(1.1), seen)
    stage(frame(2.0), seen)
    stage(frame(2.1), None)
    assert things.covers == [2, 0, 0]
    hand = HandStage(Detector([100.0, 100.0]), new_ids())
    assert len(hand(frame(0.0, depth=None)).all_landmarks) == 1  # neither measured nor named


class Named:
    """A pose estimator that keeps the names it is given."""

    def __init__(self):
        self.given = []

    def estimate(self, frame, hands=()):
        return {}

    def give_name(self, id, name):
        self.given.append((id, name))

    def close(self):
        pass


def test_a_name_reaches_the_pose_estimator_if_it_takes_names():
    named = Named()
    ObjectStage(named, CrossCameraVisibility()).give_name("object_1", "my mug")
    assert named.given == [("object_1", "my mug")]
    plain = ObjectStage(object(), CrossCameraVisibility())
    with pytest.raises(IgripError, match="--poses auto or shapes"):
        plain.give_name("object_1", "my mug")
