"""What no device may do: pass old pictures off as new, or mute itself by one wrong time."""

from __future__ import annotations

import time

import numpy as np
import pytest

import igrip.perception.cameras._polled as polled
from igrip.perception.cameras import CameraError
from igrip.perception.cameras._polled import PolledCamera
from igrip.rgbd import Intrinsics, RgbdFrame

K = Intrinsics(32, 24, 30.0, 30.0, 15.5, 11.5)


class Device(PolledCamera):
    """Sends what a function makes of the number of the picture."""

    name = "stand-in"

    def __init__(self, make):
        super().__init__()
        self.make, self.k = make, 0

    def _next(self):
        self.k += 1
        time.sleep(0.002)
        return self.make(self.k, time.monotonic())

    def _release(self):
        pass


def frame(t, value, depth=None):
    far = None if depth is None else np.full((24, 32), depth, np.float32)
    return RgbdFrame(t, np.full((24, 32, 3), value % 256, np.uint8), far, K)


def first(device, count):
    seen = []
    for one in device:
        seen.append(one)
        if len(seen) == count:
            device.close()
    return seen


def test_one_time_from_the_future_costs_one_picture():
    device = Device(lambda k, now: frame(now + 3600.0 * (k == 5), k))
    seen = first(device, 20)
    assert len(seen) == 20
    assert max(one.t for one in seen) < time.monotonic() + 0.1
    assert 5 not in [one.colour[0, 0, 0] for one in seen]


def test_a_picture_that_is_sent_again_is_no_new_one(monkeypatch):
    monkeypatch.setattr(polled, "PATIENCE", 0.2)
    device = Device(lambda k, now: frame(now, min(k, 6)))
    frames = iter(device)
    seen = [next(frames) for _ in range(6)]
    with pytest.raises(CameraError, match="no new picture"):
        next(frames)
    assert [one.colour[0, 0, 0] for one in seen] == [1, 2, 3, 4, 5, 6]


def test_new_depth_alone_makes_a_picture_new():
    device = Device(lambda k, now: frame(now, 7, depth=0.5 + 0.001 * k))
    assert len(first(device, 5)) == 5


def test_a_clock_that_was_set_ahead_ends_in_an_error(monkeypatch):
    monkeypatch.setattr(polled, "PATIENCE", 0.2)
    device = Device(lambda k, now: frame(now + 60.0 * (k > 3), k))
    frames = iter(device)
    assert len([next(frames) for _ in range(3)]) == 3
    with pytest.raises(CameraError, match="no new picture"):
        next(frames)
