"""Averages of depth: noise falls while nothing moves, and what moves is seen at once."""

from dataclasses import replace

import numpy as np
import pytest

from igrip.perception.shapes.depth_average import DepthAverage
from rgbd_frames import frame

NOISE = 0.003


def flat(depth, k=0):
    base = frame(k)
    return replace(base, depth=np.full(base.depth.shape, depth, dtype=np.float32))


def test_noise_falls_with_the_number_of_frames():
    random = np.random.default_rng(0)
    average = DepthAverage()
    for k in range(16):
        one = flat(0.8, k)
        noise = 0.003 * random.standard_normal(one.depth.shape)
        average.add(replace(one, depth=(one.depth + noise).astype(np.float32)), NOISE)
    assert np.std(average.depth) < 0.003 / 3
    assert average.depth.mean() == pytest.approx(0.8, abs=1e-3)


def test_what_is_put_in_front_or_taken_away_counts_from_the_first_frame():
    average = DepthAverage()
    for depth in (0.8, 0.8, 0.8, 0.6):
        average.add(flat(depth), NOISE)
    assert average.depth == pytest.approx(0.6)
    assert (average.counts == 1).all()


def test_a_hole_is_filled_for_a_while():
    average = DepthAverage()
    for depth in (0.8, 0.8, 0.0):
        average.add(flat(depth), NOISE)
    assert average.depth == pytest.approx(0.8)
    average.add(flat(0.0), NOISE)
    assert (average.depth == 0.0).all()


def test_a_camera_that_moves_begins_anew():
    average = DepthAverage()
    average.add(flat(0.8), NOISE)
    place = np.eye(4)
    place[0, 3] = 0.1
    average.add(replace(flat(0.805), world_from_camera=place), NOISE)
    assert (average.counts == 1).all()
