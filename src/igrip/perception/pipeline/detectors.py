"""What looks at frames: finders of hands and of objects, made for each camera."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.lab.rendering.scene import strewn_scene
from igrip.objects.catalog import Catalog
from igrip.perception.hand_detection.hand_ids import HandIdTracker, IdentityConfig, Sighting
from igrip.perception.hand_detection.palms import measure_palm
from igrip.perception.hands import HANDS, HandDetector
from igrip.perception.pipeline.merge import HandsFound, ObjectsFound
from igrip.perception.poses import POSES, PoseEstimator
from igrip.rgbd import RgbdFrame

RECENT = 0.3  # s for which a hand that was seen covers what is behind it; guess
ELSEWHERE = 1.0  # s for which a sight by another camera outweighs a miss; guess
ANOTHER_RUN = 0.5  # s by which time goes back where a recording begins anew


class HandIds:
    """Ids of hands, shared by the cameras that look at the same people; safe between threads.

    Parameters
    ----------
    config : IdentityConfig
        How many hands there are, and how they move.
    shared : bool
        Whether several cameras look at the same hands: that one of them misses a hand says little.
    """

    def __init__(self, config: IdentityConfig, shared: bool) -> None:
        self._identities = HandIdTracker(config)
        self._shared = shared
        self._lock = threading.Lock()
        self._t = 0.0

    def take(self, t: float, seen: list[Sighting]) -> Mapping[str, int | None]:
        """Return which sighting each hand is; see :class:`HandIdTracker`."""
        with self._lock:
            # cameras overtake each other by some milliseconds; what is older is another run
            self._t = t if t < self._t - ANOTHER_RUN else max(self._t, t)
            found = self._identities.update(self._t, seen)
        return {id: k for id, k in found.items() if k is not None or not self._shared}


class HandStage:
    """Finds hands, measures their palms, and keeps them apart.

    Parameters
    ----------
    finder : HandDetector
        New, for one camera.
    names : HandIds
        Of the hands.
    apart : bool
        Whether ids are told with the camera's name, as ``CAMERA/right``.
    """

    def __init__(self, finder: HandDetector, names: HandIds, apart: bool = False) -> None:
        self._finder, self._names, self._apart = finder, names, apart

    def __call__(self, frame: RgbdFrame) -> HandsFound:
        """Return the hands of a frame; those without depth on them are seen, but not measured."""
        seen = self._finder.find(frame)
        measured = [(hand, palm) for hand in seen if (palm := measure_palm(hand, frame))]
        sightings = [
            Sighting(np.array(palm.position), hand.label, hand.score) for hand, palm in measured
        ]
        hands, landmarks = {}, {}
        for id, k in self._names.take(frame.t, sightings).items():
            name = f"{frame.camera}/{id}" if self._apart else id
            hands[name] = None if k is None else measured[k][1]
            if k is not None:
                landmarks[name] = measured[k][0].landmarks
        return HandsFound(frame, hands, landmarks, [hand.landmarks for hand in seen])

    def close(self) -> None:
        """Let go of the finder."""
        self._finder.close()


class CrossCameraVisibility:
    """Which camera saw an object last: that another one misses it says little."""

    def __init__(self) -> None:
        self._seen: dict[str, tuple[str, float]] = {}
        self._lock = threading.Lock()

    def take(
        self, frame: RgbdFrame, poses: Mapping[str, ObjectPose | None]
    ) -> dict[str, ObjectPose | None]:
        """Return what one camera found, without the misses of what another saw lately."""
        told: dict[str, ObjectPose | None] = {}
        with self._lock:
            for id, pose in poses.items():
                if pose is not None:
                    told[id] = pose
                    if pose.t is None or pose.t >= frame.t:
                        self._seen[id] = frame.camera, frame.t
                    continue
                camera, t = self._seen.get(id, (frame.camera, frame.t))
                if camera == frame.camera or abs(frame.t - t) > ELSEWHERE:
                    told[id] = None
        return told


class ObjectStage:
    """Finds objects, hands being where they are.

    Parameters
    ----------
    finder : PoseEstimator
        New, for one camera.
    sights : CrossCameraVisibility
        Shared by the cameras that look at the same objects.
    """

    def __init__(self, finder: PoseEstimator, sights: CrossCameraVisibility | None = None) -> None:
        self._finder, self._sights = finder, sights or CrossCameraVisibility()

    def __call__(self, frame: RgbdFrame, hands: HandsFound | None) -> ObjectsFound:
        """Return the objects of a frame; hands of long ago cover nothing."""
        recent = hands is not None and frame.t - hands.frame.t <= RECENT
        covers = hands.seen if hands is not None and recent else ()
        poses = self._sights.take(frame, self._finder.find(frame, covers))
        return ObjectsFound(frame, poses)

    @property
    def problem(self) -> str | None:
        """What the finder says is wrong with it."""
        problem: str | None = getattr(self._finder, "problem", None)
        return problem

    def close(self) -> None:
        """Let go of the finder."""
        self._finder.close()


def hand_eye(
    name: str, most: int, apart: bool = False, cameras: int = 1
) -> Callable[[], HandStage]:
    """Return what makes a :class:`HandStage` for each camera.

    Parameters
    ----------
    name : str
        Of a hand finder.
    most : int
        Hands that are followed.
    apart : bool
        Whether each camera names its own hands; else they are fused: one id, wherever it is seen.
    cameras : int
        How many there are.

    Raises
    ------
    UnknownNameError
        If there is no such finder.
    """
    new = HANDS.get(name)
    config = IdentityConfig(hands=most)
    fused = HandIds(config, cameras > 1)

    def make() -> HandStage:
        return HandStage(new(), HandIds(config, False) if apart else fused, apart)

    return make


def object_eye(
    name: str, catalog: Catalog, options: Mapping[str, Any]
) -> Callable[[], ObjectStage]:
    """Return what makes an :class:`ObjectStage` for each camera.

    Raises
    ------
    UnknownNameError
        If there is no such finder.
    IgripError
        If its options are wrong.
    """
    new = POSES.get(name)
    sights = CrossCameraVisibility()
    first = [new(catalog, options)]  # what is wrong with its options is told now

    def make() -> ObjectStage:
        return ObjectStage(first.pop() if first else new(catalog, options), sights)

    return make


def read_options(texts: Sequence[str]) -> dict[str, Any]:
    """Return options of a pose finder from texts ``NAME=VALUE``; a value may be JSON.

    Raises
    ------
    IgripError
        If a text is not of that form.
    """
    options: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name:
            raise IgripError(f"option {text!r}: write NAME=VALUE")
        try:
            options[name] = json.loads(value) if value[:1] in "{[" else value
        except ValueError as error:
            raise IgripError(f"option {name}: is no JSON: {error}") from None
    return options


def warm_up_eyes(
    new_hands: Callable[[], HandStage] | None, new_objects: Callable[[], ObjectStage] | None,
    catalog: Catalog, models: Sequence[str],
) -> None:  # fmt: skip
    """Compile, and fetch what is missing, before a camera runs: look at a rendered table once."""
    random = np.random.default_rng(0)
    scene = strewn_scene(catalog, list(models)[:1], random)  # one always finds a place
    frame = replace(scene.frame(0.0, random), camera="warm-up")
    found = None
    if new_hands is not None:
        hand = new_hands()
        found = hand(frame)
        hand.close()
    if new_objects is not None:
        thing = new_objects()
        thing(frame, found)
        thing.close()
