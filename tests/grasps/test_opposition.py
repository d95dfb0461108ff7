"""Opposing contacts: of a box the distances of its sides, of a ball its diameter."""

from __future__ import annotations

import numpy as np
import pytest

from grasps.shapes import SHAPES
from igrip.grasps.opposition import MAX_OPENING, find_oppositions
from igrip.grasps.surface import sample_surface


def pairs_of(name):
    mesh = SHAPES[name]()
    return find_oppositions(sample_surface(mesh.vertices, mesh.faces))


def test_of_a_box_only_the_sides_that_a_hand_can_span():
    pairs = pairs_of("box")  # 7 × 16 × 21 cm
    assert pairs.opening == pytest.approx(0.07, abs=0.002)
    assert np.abs(pairs.closing[:, 0]).min() > 0.98


def test_of_a_ball_its_diameter_through_its_middle():
    pairs = pairs_of("ball")
    assert pairs.opening == pytest.approx(0.072, abs=0.002)
    assert np.linalg.norm(pairs.centre, axis=1).max() < 0.004


def test_a_thin_wall_and_the_whole_of_a_mug():
    opening = pairs_of("mug").opening
    assert ((opening > 0.003) & (opening < 0.005)).sum() > 50  # its wall is 4 mm
    assert ((opening > 0.075) & (opening < 0.082)).sum() > 50  # and it is 8 cm across
    assert opening.max() <= MAX_OPENING
