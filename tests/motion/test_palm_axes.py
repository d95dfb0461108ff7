"""How a hand is turned, from landmarks or orientation: one made by hand, in any frame."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.entities import Hand
from igrip.motion.palm_axes import palm_axes

ROTATIONS = st.integers(0, 10_000).map(lambda seed: Rotation.random(rng=seed))


def landmarks():
    """Return a palm in the plane z = 0 whose tips meet over its middle."""
    points = np.zeros((21, 3))
    points[5], points[17] = [-0.03, 0.03, 0.0], [0.03, 0.03, 0.0]
    points[0] = [0.0, -0.06, 0.0]
    points[[4, 8, 12]] = [0.0, 0.0, 0.08]
    return points


@given(ROTATIONS)
def test_by_landmarks(turn):
    hand = Hand(position=(0, 0, 0), landmarks=turn.apply(landmarks()))
    axes = palm_axes(hand)
    assert axes.across == pytest.approx(turn.apply([1, 0, 0]), abs=1e-9)
    assert axes.ahead == pytest.approx(turn.apply([0, 0, 1]), abs=1e-9)


@given(ROTATIONS)
def test_by_orientation(turn):
    axes = palm_axes(Hand(position=(0, 0, 0), orientation=turn.as_quat()))
    assert axes.across == pytest.approx(turn.as_matrix()[:, 0], abs=1e-9)
    assert axes.ahead == pytest.approx(turn.as_matrix()[:, 2], abs=1e-9)


def test_unknown():
    assert palm_axes(Hand(position=(0, 0, 0))) is None
    assert palm_axes(Hand(position=(0, 0, 0), landmarks=np.zeros((21, 3)))) is None
    assert palm_axes(Hand(position=(0, 0, 0), landmarks=landmarks()[:5])) is None
