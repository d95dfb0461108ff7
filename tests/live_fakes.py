"""Cameras and stages that do what a test says, when it says so: no test waits for a clock."""

from __future__ import annotations

import threading

import numpy as np

from igrip.entities import Hand, ObjectPose
from igrip.perception.pipeline.merge import DetectedHands, DetectedObjects
from igrip.rgbd import Intrinsics, RgbdFrame

LIMIT = 60.0  # s that a condition is waited for: only a failing test ever does


def frame(t, camera="camera"):
    picture = np.zeros((4, 6, 3), np.uint8)
    return RgbdFrame(t, picture, None, Intrinsics(6, 4, 5.0, 5.0, 2.5, 1.5), camera)


class Clock:
    """A clock that moves when it is told to [s]."""

    def __init__(self, t=100.0):
        self.t = t

    def __call__(self):
        return self.t

    def advance(self, seconds):
        self.t += seconds


class FakeCamera:
    """Yields frames of a clock that it moves on; then ends, fails, or waits to be closed.

    Parameters
    ----------
    clock : Clock
        Of the frames.
    count : int
        Frames of each camera.
    before : function
        Called with the number of each frame before it is yielded; may wait for something.
    error : Exception, optional
        Raised in the end.
    endless : bool
        Whether it then waits until it is closed.
    cameras : sequence of str
        Names of the cameras.
    """

    def __init__(
        self, clock, count=10, before=lambda k: None, error=None, endless=False,
        cameras=("camera",),
    ):  # fmt: skip
        self.clock, self.count, self.before = clock, count, before
        self.error, self.endless, self.cameras = error, endless, cameras
        self.closed = threading.Event()

    def __iter__(self):
        for k in range(self.count):
            self.before(k)
            self.clock.advance(1 / 30)
            for camera in self.cameras:
                yield frame(self.clock(), camera)
        if self.error is not None:
            raise self.error
        if self.endless:
            assert self.closed.wait(LIMIT)

    def close(self):
        self.closed.set()


def hand_stage(work=lambda frame: None):
    """Return a stage of one hand; ``work`` is called first, and may wait or fail."""

    def stage(frame):
        work(frame)
        x = 0.1 * (frame.t % 1.0)
        return DetectedHands(frame, {"right": Hand(position=(x, 0.0, 0.5), t=frame.t)}, {})

    return stage


def object_stage(work=lambda frame, hands: None):
    """Return a stage of one object; ``work`` is called first, and may wait or fail."""

    def stage(frame, hands):
        work(frame, hands)
        pose = ObjectPose(
            position=(0.0, 0.1, 0.8), orientation=(0.0, 0.0, 0.0, 1.0), model="box", t=frame.t
        )
        return DetectedObjects(frame, {"box": pose})

    return stage
