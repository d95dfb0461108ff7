"""Polled devices: no old picture passes for a new one, and errors say what is known."""

from __future__ import annotations

import re
import threading

import numpy as np
import pytest

from igrip.errors import CameraError
from igrip.perception.cameras._polled import PATIENCE, PolledCamera
from igrip.rgbd import Intrinsics, RgbdFrame

K = Intrinsics(32, 24, 30.0, 30.0, 15.5, 11.5)


class Device(PolledCamera):
    """Returns what a function makes of the number of the picture; each takes 0.1 s of its clock."""

    name = "stand-in"

    def __init__(self, make):
        super().__init__()
        self.make, self.k, self.now = make, 0, 100.0

    def clock(self):
        return self.now

    def _next(self):
        self.k += 1
        self.now += 0.1
        return self.make(self.k, self.now)

    def _release(self):
        pass


def frame(t, value, depth=None):
    far = None if depth is None else np.full((24, 32), depth, np.float32)
    return RgbdFrame(t, np.full((24, 32, 3), value % 256, np.uint8), far, K)


def first(device, count):
    frames = []
    for one in device:
        frames.append(one)
        if len(frames) == count:
            device.close()
    return frames


def error_after(device, count):
    """Return the message of the error that comes after so many frames."""
    frames = iter(device)
    for _ in range(count):
        next(frames)
    with pytest.raises(CameraError) as caught:
        next(frames)
    return str(caught.value)


def test_one_time_from_the_future_costs_one_picture():
    device = Device(lambda k, now: frame(now + 3600.0 * (k == 5), k))
    frames = first(device, 20)
    assert len(frames) == 20
    assert max(one.t for one in frames) <= device.now
    assert 5 not in [one.colour[0, 0, 0] for one in frames]


def test_new_depth_alone_makes_a_picture_new():
    device = Device(lambda k, now: frame(now, 7, depth=0.5 + 0.001 * k))
    assert len(first(device, 5)) == 5


def test_a_picture_that_is_sent_again_is_no_new_one():
    device = Device(lambda k, now: frame(now, 100 + min(k, 6)))
    message = error_after(device, 6)
    assert message.startswith(f"for {PATIENCE:g} s stand-in has sent the same picture again")
    assert "plug it in again" in message
    assert device.k == pytest.approx(6 + PATIENCE / 0.1, abs=2)


def test_a_closed_shutter_is_not_taken_for_a_pulled_cable():
    """Reported as "is it still plugged in?" while pictures came, all of them black."""
    device = Device(lambda k, now: frame(now, 100 + k if k < 4 else 0))
    message = error_after(device, 4)  # the first black one is new
    assert "has sent black pictures only; open its shutter" in message
    assert "plug" not in message


def test_without_any_picture_it_may_be_unplugged():
    device = Device(lambda k, now: frame(now, k) if k < 4 else None)
    message = error_after(device, 3)
    assert "has sent no picture; is it still plugged in" in message
    # black at first, then nothing at all
    device = Device(lambda k, now: frame(now, 0) if k < 10 else None)
    assert "has sent no picture" in error_after(device, 1)


def test_wrong_times_are_named():
    device = Device(lambda k, now: frame(now + 60.0 * (k > 3), k))
    assert "has sent pictures dated 60.0 s in the future" in error_after(device, 3)
    device = Device(lambda k, now: frame(100.0 + min(k, 3) / 30, k))
    assert "pictures whose time does not increase" in error_after(device, 3)


@pytest.mark.parametrize("step", [60.0, -60.0])
def test_a_clock_that_was_set_is_followed_and_named(step):
    device = Device(lambda k, now: frame(now - 0.03 + step * (k > 30), k))
    frames = first(device, 60)
    late = [one.t for one in frames[-10:]]
    assert np.diff(late) == pytest.approx(0.1)
    assert device.now - late[-1] == pytest.approx(0.03, abs=0.01)
    assert re.search(rf"stepped {'ahead' if step > 0 else 'back'} by (60|59\.9)", device.note)


def test_dark_pictures_with_noise_come_with_a_note_until_they_are_over():
    random = np.random.default_rng(0)

    def make(k, now):
        low = 0 if 5 <= k < 40 else 90
        colour = random.integers(low, low + 8, (24, 32, 3), np.uint8)
        return RgbdFrame(now, colour, None, K)

    device = Device(make)
    notes = [device.note for _ in zip(range(60), device, strict=False)]
    assert notes[:5] == [None] * 5
    black = [k for k, note in enumerate(notes) if note is not None]
    assert black == list(range(black[0], 39))
    assert 15 <= black[0] <= 25  # not at once: exposures settle
    assert "stand-in: its pictures are black; open its shutter" in notes[30]


def test_depth_that_is_missing_altogether_comes_with_a_note():
    device = Device(lambda k, now: frame(now, 100 + k, depth=0.0 if k < 30 else 0.5))
    device.device_note = "an old one"
    notes = [device.note for _ in zip(range(40), device, strict=False)]
    assert notes[0] == notes[39] == "an old one"
    assert notes[28] == (
        "an old one; stand-in: it measures no depth at all; uncover both of its depth sensors, "
        "and leave the least distance of its data sheet before it"
    )


@pytest.mark.parametrize("error", [RuntimeError("gone"), CameraError("it has stopped")])
def test_an_error_of_a_device_that_is_closed_meanwhile_is_none(error):
    """Closing from another thread was answered with "is it still plugged in?" by some drivers."""

    def make(k, now):
        if k < 3:
            return frame(now, k)
        closing = threading.Thread(target=device.close)
        closing.start()
        assert device._closing.wait(60.0)
        raise error

    device = Device(make)
    assert len(list(device)) == 2


def test_an_error_of_an_open_device_is_raised():
    def make(k, now):
        raise RuntimeError("gone")

    with pytest.raises(CameraError, match=r"stand-in has stopped \(gone\); is it still plugged in"):
        list(Device(make))
