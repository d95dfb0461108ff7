"""Declared frames: what they convert, against matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.io.frames import AXES_BY_UP, MIRROR, DeclaredFrame, FrameError

SEEDS = st.integers(0, 2**32 - 1)


@given(st.sampled_from(sorted(AXES_BY_UP)), st.sampled_from(["right", "left"]), SEEDS)
def test_the_declared_axis_points_up_and_a_point_of_a_mesh_lands_where_it_was(up, hand, seed):
    frame = DeclaredFrame.declare(up=up, handedness=hand, length_unit="mm", quaternions="wxyz")
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    assert frame.positions(axis) == pytest.approx([0.0, 0.0, 0.001])
    random = np.random.default_rng(seed)
    rotation, place, point = (
        Rotation.random(rng=random),
        random.normal(size=3),
        random.normal(size=3),
    )
    mesh = MIRROR if hand == "left" else np.eye(3)
    in_source = place + rotation.apply(mesh @ point)  # [mm]
    turned = Rotation.from_quat(frame.orientations(np.roll(rotation.as_quat(), 1)))
    in_igrip = frame.positions(place) + turned.apply(point) / 1000.0
    assert in_igrip == pytest.approx(frame.positions(in_source))


@given(st.sampled_from(sorted(AXES_BY_UP)), st.sampled_from(["right", "left"]))
def test_what_is_written_down_declares_the_same_frame(up, hand):
    frame = DeclaredFrame.declare(up=up, handedness=hand, time_unit="ms")
    assert DeclaredFrame.declare(**frame.to_dict()) == frame


def test_units_and_deviations():
    frame = DeclaredFrame.declare(axes="x, -Z, y", length_unit="cm", time_unit="us")
    assert frame.times([5e5]) == pytest.approx([0.5])
    assert frame.deviations([1.0, 2.0, 3.0]) == pytest.approx([0.01, 0.03, 0.02])
    assert frame.deviations(2.0) == pytest.approx(0.02)
    assert DeclaredFrame().is_default
    assert not frame.is_default


def test_axes_of_a_left_handed_source_need_no_second_word():
    assert DeclaredFrame.declare(axes=["x", "z", "y"]).left_handed


def test_a_quaternion_of_zeros_or_nan_stays_one():
    frame = DeclaredFrame.declare(up="y")
    assert frame.orientations([0.0] * 4) == pytest.approx([0.0] * 4)
    assert np.isnan(frame.orientations([np.nan] * 4)).all()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ({"up": "q"}, "up"),
        ({"axes": "x,y,y"}, "twice"),
        ({"axes": "x,y"}, "axes"),
        ({"axes": "x,,y"}, "axes"),
        ({"axes": "x,yz,y"}, "axes"),
        ({"axes": "x,z,y", "handedness": "right"}, "left-handed"),
        ({"up": "y", "axes": "x,-z,y"}, "not both"),
        ({"handedness": "both"}, "handedness"),
        ({"quaternions": "xywz"}, "quaternions"),
        ({"length_unit": "km"}, "length_unit"),
        ({"time_unit": "h"}, "time_unit"),
    ],
)
def test_a_word_that_is_wrong_is_named(words, named):
    with pytest.raises(FrameError, match=named):
        DeclaredFrame.declare(**words)
