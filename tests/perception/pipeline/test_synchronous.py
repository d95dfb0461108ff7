"""The pipeline frame by frame: order, delays, rates."""

from __future__ import annotations

import itertools

import pytest

from igrip.perception.pipeline.synchronous import observe
from live_fakes import frame, hand_stage, object_stage


def test_results_arrive_when_those_of_a_live_pipeline_would():
    frames = [frame(10.0 + k / 30) for k in range(12)]
    messages = list(observe(frames, hand_stage(), object_stage(), objects_every=4,
                        hands_delay=0.02, objects_delay=0.11))  # fmt: skip
    hands, objects = [m for m in messages if m.hands], [m for m in messages if m.objects]
    assert (len(hands), len(objects)) == (12, 3)
    assert [m.t for m in messages] == sorted(m.t for m in messages)
    for k, message in enumerate(hands):
        assert message.t == pytest.approx(k / 30 + 0.02)
        assert message.hands["right"].t == pytest.approx(k / 30)
    assert [m.objects["box"].t for m in objects] == pytest.approx([0.0, 4 / 30, 8 / 30])
    assert all(m.t - m.objects["box"].t == pytest.approx(0.11) for m in objects)


def test_it_may_be_hands_alone_or_nothing():
    frames = [frame(k / 30) for k in range(3)]
    assert len(list(observe(frames, hand_stage(), None))) == 3
    assert not list(observe([], hand_stage(), object_stage()))
    assert not list(itertools.islice(observe(frames, None, None), 1))
