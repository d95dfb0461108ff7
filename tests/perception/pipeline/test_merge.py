"""One clock for all results: times of arrival that never decrease, times of measurement kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.entities import Hand, ObjectPose
from igrip.perception.pipeline.merge import DetectedHands, DetectedObjects, Merger
from igrip.rgbd import Intrinsics, RgbdFrame

BOX = {"model": "box", "orientation": (0.0, 0.0, 0.0, 1.0)}


def frame(t):
    picture = np.zeros((2, 2, 3), np.uint8)
    return RgbdFrame(t, picture, None, Intrinsics(2, 2, 1.0, 1.0, 0.5, 0.5))


def hands(t):
    return DetectedHands(frame(t), {"right": Hand(position=(0.0, 0.0, 0.5)), "left": None}, {})


def objects(t, own):
    return DetectedObjects(frame(t), {"box": ObjectPose(position=(0.0, 0.0, 1.0), t=own, **BOX)})


def test_results_are_stamped_on_arrival_and_keep_their_time_of_exposure():
    merger = Merger(100.0)
    message = merger.observation(hands(100.50), now=100.53)
    assert message.t == pytest.approx(0.53)
    assert message.hands["right"].t == pytest.approx(0.50)
    assert message.hands["left"] is None
    message = merger.observation(objects(100.4, own=100.1), now=100.6)
    assert message.objects["box"].t == pytest.approx(0.1)  # hidden since then


def test_what_was_measured_before_the_stream_is_left_out():
    merger = Merger(100.0)
    assert not merger.observation(hands(99.0), now=100.1).hands
    assert not merger.observation(objects(100.05, own=99.0), now=100.2).objects


def test_a_tick_ends_the_silence():
    merger = Merger(5.0)
    assert merger.silence(5.06) == pytest.approx(0.06)
    tick = merger.tick(5.06)
    assert tick.t == pytest.approx(0.06)
    assert not tick.hands
    assert not tick.objects
    assert merger.silence(5.06) == pytest.approx(0.0)


@given(st.lists(st.tuples(st.booleans(), st.floats(-0.2, 3.0), st.floats(0.0, 0.3)), max_size=20))
def test_times_never_decrease_and_are_never_negative(results):
    merger, last = Merger(1000.0), 0.0
    for is_hand, at, delay in results:
        found = hands(1000.0 + at) if is_hand else objects(1000.0 + at, 1000.0 + at - 0.1)
        message = merger.observation(found, 1000.0 + at + delay)
        assert message.t >= last
        last = message.t
        for entity in (*message.hands.values(), *message.objects.values()):
            assert entity is None or entity.t >= 0.0
