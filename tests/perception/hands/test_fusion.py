"""Several measurements of hands as one each, against weights worked out on paper."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.entities import Hand
from igrip.perception.hands import LANDMARKS, HandDetection
from igrip.perception.hands._fusion import fuse


def hand(x, std, label=None, points=3, y=0.0):
    measured = Hand(position=(x, y, 0.6), std=(std, std, std), t=0.0)
    return HandDetection(np.zeros((points, 2)), 0.8, label, measured)


def test_the_surer_weighs_more_and_is_named_first():
    found = fuse([("mediapipe", [hand(0.0, 0.005, "right", LANDMARKS)]),
                  ("depth", [hand(0.03, 0.010)])], "oak")  # fmt: skip
    assert len(found) == 1
    assert found[0].measured.position[0] == pytest.approx(0.03 / 5)
    assert found[0].measured.std[0] == pytest.approx(0.005 * np.sqrt(4 / 5))
    assert found[0].measured.source == "oak mediapipe+depth"
    assert found[0].label == "right"
    assert len(found[0].landmarks) == LANDMARKS


def test_the_order_of_detectors_changes_no_position():
    one, other = hand(0.0, 0.01), hand(0.04, 0.02)
    a = fuse([("a", [one]), ("b", [other])], "c")[0].measured.position
    b = fuse([("b", [other]), ("a", [one])], "c")[0].measured.position
    assert a == pytest.approx(b)


def test_who_alone_sees_a_hand_speaks_for_it():
    found = fuse([("mediapipe", []), ("depth", [hand(0.3, 0.01)])], "oak")
    assert [one.measured.source for one in found] == ["oak depth"]


def test_two_hands_stay_two():
    near, far = hand(0.0, 0.005), hand(0.4, 0.005)
    found = fuse([("a", [near, far]), ("b", [hand(0.41, 0.01), hand(0.02, 0.01)])], "c")
    assert sorted(round(one.measured.position[0], 2) for one in found) == [0.0, 0.4]


def test_one_detector_never_reports_one_hand_twice():
    found = fuse([("a", [hand(0.0, 0.02), hand(0.05, 0.02)])], "c")
    assert len(found) == 2
