"""The shape of an arm's end: of a rod by its sizes, and the same however it is turned."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.perception.arms.end_shape import INPUTS, SECTIONS, end_shape

ENTRY, CAMERA = np.array([0.5, 0.0, 0.1]), np.array([0.1, 0.2, 0.9])


def upper_half(radius=0.03, length=0.4, seed=0):
    """Return points on the upper side of a rod that lies along x and ends at x = 0."""
    random = np.random.default_rng(seed)
    angle = random.uniform(0.0, np.pi, 6000)
    along = random.uniform(0.0, length, 6000)
    return np.stack([along, radius * np.cos(angle), 0.1 + radius * np.sin(angle)], axis=1)


def test_a_rod_is_as_broad_and_high_as_it_is():
    shape = end_shape(upper_half(), ENTRY, CAMERA)
    breadth, low, high, height = shape.inputs[:-3].reshape(4, SECTIONS)
    assert shape.inputs.shape == (INPUTS,)
    assert shape.tip == pytest.approx([0.0, 0.0, 0.12], abs=0.015)
    assert np.median(breadth) == pytest.approx(0.03, abs=0.006)
    assert np.median(high - low) == pytest.approx(0.06, abs=0.006)
    assert np.ptp(height) < 0.015  # half a radius: the tip may lie lower than the middle
    assert shape.frame @ shape.frame.T == pytest.approx(np.eye(3), abs=1e-12)
    assert shape.frame[0] == pytest.approx([1.0, 0.0, 0.0], abs=0.05)
    assert shape.frame[2, 2] > 0.95  # towards the camera, which is above


@pytest.mark.parametrize("seed", range(5))
def test_turning_everything_changes_little(seed):
    """The median of the farthest points, which stands for the tip, goes by the axes."""
    points = upper_half(seed=seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    one = end_shape(points, ENTRY, CAMERA)
    other = end_shape(points @ turn.T, turn @ ENTRY, turn @ CAMERA)
    assert other.inputs[:-3] == pytest.approx(one.inputs[:-3], abs=0.006)
    assert other.inputs[-3:] == pytest.approx(one.inputs[-3:], abs=0.08)
    assert other.tip == pytest.approx(turn @ one.tip, abs=0.006)
    assert other.frame == pytest.approx(one.frame @ turn.T, abs=0.08)


def test_a_gap_between_rods_counts_as_filled():
    rods = [upper_half(0.004) + [0.0, y, 0.0] for y in (-0.02, -0.007, 0.007, 0.02)]
    shape = end_shape(np.concatenate(rods), ENTRY, CAMERA)
    assert np.median(shape.inputs[:SECTIONS]) == pytest.approx(0.024, abs=0.006)


def test_a_few_points_are_no_end():
    assert end_shape(upper_half()[:20], ENTRY, CAMERA) is None
