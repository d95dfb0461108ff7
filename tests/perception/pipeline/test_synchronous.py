"""The chain frame by frame: order, delays, rates."""

from __future__ import annotations

import itertools

import pytest

from igrip.perception.pipeline.synchronous import observe
from live_fakes import frame, hands_finder, objects_finder


def test_each_frame_is_told_when_a_live_chain_would():
    frames = [frame(10.0 + k / 30) for k in range(12)]
    told = list(observe(frames, hands_finder(), objects_finder(), objects_every=4,
                        hands_delay=0.02, objects_delay=0.11))  # fmt: skip
    hands, objects = [m for m in told if m.hands], [m for m in told if m.objects]
    assert (len(hands), len(objects)) == (12, 3)
    assert [m.t for m in told] == sorted(m.t for m in told)
    for k, message in enumerate(hands):
        assert message.t == pytest.approx(k / 30 + 0.02)
        assert message.hands["right"].t == pytest.approx(k / 30)
    assert [m.objects["box"].t for m in objects] == pytest.approx([0.0, 4 / 30, 8 / 30])
    assert all(m.t - m.objects["box"].t == pytest.approx(0.11) for m in objects)


def test_it_may_be_hands_alone_or_nothing():
    frames = [frame(k / 30) for k in range(3)]
    assert len(list(observe(frames, hands_finder(), None))) == 3
    assert not list(observe([], hands_finder(), objects_finder()))
    assert not list(itertools.islice(observe(frames, None, None), 1))
