"""Several detectors as one: who speaks, who is missing, and one id throughout."""

from __future__ import annotations

import numpy as np
import pytest

from arms_from_above import View, palm_point
from igrip.entities import Hand
from igrip.errors import IgripError, MissingExtraError, UnknownNameError
from igrip.perception.hand_ids import HandIdConfig
from igrip.perception.hands import HANDS, LANDMARKS, HandDetection
from igrip.perception.hands.auto import AutoHands
from igrip.perception.pipeline.stages import HandIds, HandStage


class Sometimes:
    """Sees one hand where it is told to, with landmarks, in some frames."""

    def __init__(self, options=None):
        self.count = 0

    def detect(self, frame):
        self.count += 1
        if self.count < 20 or self.count % 10 < 5:
            return []
        measured = Hand(position=tuple(palm_point(0.0, 0.0)), std=(0.004,) * 3, t=frame.t)
        return [HandDetection(np.zeros((LANDMARKS, 2)), 0.9, "left", measured)]

    def close(self):
        pass


class Missing:
    def __init__(self, options=None):
        raise MissingExtraError("nothing", "hands", "detecting hands")


@pytest.fixture
def members(monkeypatch):
    monkeypatch.setitem(HANDS._members, "sometimes", Sometimes)
    monkeypatch.setitem(HANDS._members, "missing", Missing)


def scenes(count=45):
    for k in range(count):
        view = View(k)
        if k >= 4:
            view = view.arm((0.0, max(0.0, 0.4 - 0.03 * (k - 4))), (0.05, 0.8))
        yield view.frame(k / 30)


def test_one_id_whoever_speaks_and_it_is_told(members):
    auto = AutoHands({"members": ["sometimes", "depth"]})
    stage = HandStage(auto, HandIds(HandIdConfig(), False))
    ids, sources = set(), set()
    for frame in scenes():
        found = stage(frame).hands
        ids |= set(found)
        if frame.t > 19 / 30:
            assert None not in found.values()
            sources |= {hand.source for hand in found.values()}
    assert len(ids) == 1
    assert sources == {"above depth", "above sometimes+depth"}


def test_a_missing_package_leaves_the_others_and_is_told(members):
    auto = AutoHands({"members": ["missing", "depth"]})
    found = [auto.detect(frame) for frame in scenes(20)]
    assert len(found[-1]) == 1
    assert "missing" in auto.problem


def test_with_nothing_that_works_it_ends(members):
    with pytest.raises(IgripError):
        AutoHands({"members": ["missing"]})
    with pytest.raises(UnknownNameError):
        AutoHands({"members": ["nobody"]})


def test_without_depth_it_asks_those_that_need_none(members):
    auto = AutoHands({"members": ["sometimes", "depth"]})
    for frame in scenes(12):
        bare = type(frame)(frame.t, frame.colour, None, frame.intrinsics, frame.camera)
        auto.detect(bare)
    assert auto.problem is None
