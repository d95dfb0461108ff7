"""What is done with each frame: a stage for hands and one for objects, made for each camera."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.lab.rendering.scene import random_scene
from igrip.objects.catalog import Catalog
from igrip.perception.hand_ids import HandIdConfig, HandIdTracker, PalmMeasurement
from igrip.perception.hands import HANDS, HandDetector, new_detector
from igrip.perception.hands._palms import measure_palm
from igrip.perception.pipeline.merge import DetectedHands, DetectedObjects
from igrip.perception.poses import POSES, PoseEstimator
from igrip.rgbd import RgbdFrame

MAX_HANDS_AGE = 0.3  # s for which detected hands cover what is behind them; guess
OTHER_CAMERA = 1.0  # s for which an object that one camera sees is not missed by another; guess
NEW_RUN = 0.5  # s by which time goes back where a recording begins anew


class HandIds:
    """Ids of hands, shared by the cameras that look at the same people; safe between threads.

    ``shared``: several cameras look at the same hands, so that a miss of one is weak evidence.
    """

    def __init__(self, config: HandIdConfig, shared: bool) -> None:
        self._tracker = HandIdTracker(config)
        self._shared = shared
        self._lock = threading.Lock()
        self._t = 0.0

    def update(self, t: float, palms: list[PalmMeasurement]) -> Mapping[str, int | None]:
        """Return which palm each hand is; see :class:`igrip.perception.hand_ids.HandIdTracker`."""
        with self._lock:
            # cameras overtake each other by some milliseconds; what is older is another run
            self._t = t if t < self._t - NEW_RUN else max(self._t, t)
            matches = self._tracker.update(self._t, palms)
        return {id: k for id, k in matches.items() if k is not None or not self._shared}


class HandStage:
    """Detects hands, measures their palms, and gives them ids.

    ``detector`` is that of one camera. ``separate``: ids begin with its name (``CAMERA/right``).
    """

    def __init__(self, detector: HandDetector, ids: HandIds, separate: bool = False) -> None:
        self._detector, self._ids, self._separate = detector, ids, separate

    def __call__(self, frame: RgbdFrame) -> DetectedHands:
        """Return the hands of a frame; those without depth on them are not measured."""
        detections = self._detector.detect(frame)
        measured = [(hand, palm) for hand in detections if (palm := measure_palm(hand, frame))]
        palms = [
            PalmMeasurement(np.array(palm.position), hand.label, hand.score)
            for hand, palm in measured
        ]
        hands, landmarks = {}, {}
        for id, k in self._ids.update(frame.t, palms).items():
            name = f"{frame.camera}/{id}" if self._separate else id
            hands[name] = None if k is None else measured[k][1]
            if k is not None:
                landmarks[name] = measured[k][0].landmarks
        return DetectedHands(frame, hands, landmarks, [hand.landmarks for hand in detections])

    @property
    def problem(self) -> str | None:
        """What is wrong with the detector just now."""
        problem: str | None = getattr(self._detector, "problem", None)
        return problem

    def close(self) -> None:
        """Close the detector."""
        self._detector.close()


class CrossCameraVisibility:
    """Which camera saw an object last: that another one misses it is weak evidence."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[str, float]] = {}  # camera and time, by object
        self._lock = threading.Lock()

    def filter(
        self, frame: RgbdFrame, poses: Mapping[str, ObjectPose | None]
    ) -> dict[str, ObjectPose | None]:
        """Return one camera's poses, without the misses of what another camera saw lately."""
        kept: dict[str, ObjectPose | None] = {}
        with self._lock:
            for id, pose in poses.items():
                if pose is not None:
                    kept[id] = pose
                    if pose.t is None or pose.t >= frame.t:
                        self._last[id] = frame.camera, frame.t
                    continue
                camera, t = self._last.get(id, (frame.camera, frame.t))
                if camera == frame.camera or abs(frame.t - t) > OTHER_CAMERA:
                    kept[id] = None
        return kept


class ObjectStage:
    """Estimates poses of objects, hands being where they are.

    ``pose_estimator`` is that of one camera; ``visibility`` is shared by the cameras that look at
    the same objects.
    """

    def __init__(self, pose_estimator: PoseEstimator, visibility: CrossCameraVisibility) -> None:
        self._estimator, self._visibility = pose_estimator, visibility

    def __call__(self, frame: RgbdFrame, hands: DetectedHands | None) -> DetectedObjects:
        """Return the objects of a frame; hands of long ago cover nothing."""
        recent = hands is not None and frame.t - hands.frame.t <= MAX_HANDS_AGE
        covering = hands.all_landmarks if hands is not None and recent else ()
        poses = self._visibility.filter(frame, self._estimator.estimate(frame, covering))
        return DetectedObjects(frame, poses)

    @property
    def problem(self) -> str | None:
        """What is wrong with the pose estimator just now."""
        problem: str | None = getattr(self._estimator, "problem", None)
        return problem

    def give_name(self, id: str, name: str) -> None:
        """Give an unknown thing a name, from the next run on; an IgripError says why not."""
        give = getattr(self._estimator, "give_name", None)
        if give is None:
            raise IgripError("names are given to unknown things: --poses auto or shapes")
        give(id, name)

    def close(self) -> None:
        """Close the pose estimator."""
        self._estimator.close()


def hand_stages(
    name: str, max_hands: int, separate: bool = False, cameras: int = 1,
    options: Mapping[str, Any] | None = None,
) -> Callable[[], HandStage]:  # fmt: skip
    """Return a function that makes a :class:`HandStage` for each camera.

    An unknown detector or wrong options raise an IgripError at once.

    Parameters
    ----------
    name : str
        Of a hand detector.
    max_hands : int
        Hands that are followed.
    separate : bool
        Whether each camera names its own hands; else they are fused: one id in all cameras.
    cameras : int
        How many there are.
    options : mapping, optional
        Of the detector.
    """
    HANDS.check(name)
    # so that wrong options are reported now; one without options may take a while to make
    first = [new_detector(name, options)] if options else []
    config = HandIdConfig(max_hands=max_hands)
    fused = HandIds(config, cameras > 1)

    def new_stage() -> HandStage:
        detector = first.pop() if first else new_detector(name, options)
        return HandStage(detector, HandIds(config, False) if separate else fused, separate)

    return new_stage


def object_stages(
    name: str, catalog: Catalog, options: Mapping[str, Any]
) -> Callable[[], ObjectStage]:
    """Return a function that makes an :class:`ObjectStage` for each camera.

    An unknown pose estimator or wrong options raise an IgripError at once.
    """
    new_estimator = POSES.get(name)
    visibility = CrossCameraVisibility()
    first = new_estimator(catalog, options)  # so that wrong options are reported now
    unused = [first]
    # one that names things itself shares what it knows with those of other cameras
    sibling = getattr(first, "sibling", lambda: new_estimator(catalog, options))

    def new_stage() -> ObjectStage:
        return ObjectStage(unused.pop() if unused else sibling(), visibility)

    return new_stage


def warm_up_stages(
    new_hands: Callable[[], HandStage] | None, new_objects: Callable[[], ObjectStage] | None,
    catalog: Catalog, models: Sequence[str],
) -> None:  # fmt: skip
    """Compile, and fetch what is missing, on a rendered table before a camera runs."""
    random = np.random.default_rng(0)
    scene = random_scene(catalog, list(models)[:1], random)  # one object always finds a place
    frame = replace(scene.frame(0.0, random), camera="warm-up")
    detected = None
    if new_hands is not None:
        hands = new_hands()
        detected = hands(frame)
        hands.close()
    if new_objects is not None:
        objects = new_objects()
        objects(frame, detected)
        objects.close()
