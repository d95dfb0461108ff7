"""Cameras and finders that do what a test says."""

from __future__ import annotations

import threading
import time

import numpy as np

from igrip.entities import Hand, ObjectPose
from igrip.perception.pipeline.merge import HandsFound, ObjectsFound
from igrip.rgbd import Intrinsics, RgbdFrame


def frame(t, camera="camera"):
    picture = np.zeros((4, 6, 3), np.uint8)
    return RgbdFrame(t, picture, None, Intrinsics(6, 4, 5.0, 5.0, 2.5, 1.5), camera)


class FakeCamera:
    """Yields so many frames at a rate; then ends, or fails, or goes on until it is closed."""

    def __init__(self, count=None, rate=100.0, error=None, cameras=("camera",)):
        self.count, self.rate, self.error, self.cameras = count, rate, error, cameras
        self.closed = threading.Event()
        self.yielded = 0

    def __iter__(self):
        while not self.closed.is_set() and (self.count is None or self.yielded < self.count):
            for camera in self.cameras:
                yield frame(time.monotonic(), camera)
            self.yielded += 1
            self.closed.wait(1.0 / self.rate)
        if self.error is not None and not self.closed.is_set():
            raise self.error

    def close(self):
        self.closed.set()


def hands_finder(takes=0.0, fails=lambda n: False, seen=None):
    """Return a finder of one hand that takes so long [s]."""
    count = iter(range(10**9))

    def find(frame):
        time.sleep(takes)
        if fails(next(count)):
            raise ValueError("a strange picture")
        if seen is not None:
            seen.append(frame)
        x = 0.1 * (frame.t % 1.0)
        return HandsFound(frame, {"right": Hand(position=(x, 0.0, 0.5), t=frame.t)}, {})

    return find


def objects_finder(takes=0.0, given=None):
    def find(frame, hands):
        time.sleep(takes)
        if given is not None:
            given.append(hands)
        pose = ObjectPose(
            position=(0.0, 0.1, 0.8), orientation=(0.0, 0.0, 0.0, 1.0), model="box", t=frame.t
        )
        return ObjectsFound(frame, {"box": pose})

    return find
