"""Hands put into frames: where they were put, as large as they should be, behind what is nearer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hands import CAMERA, desk
from igrip.lab.rendering.drawn_hand import PALM_LENGTH, draw_hand, paste_hand
from igrip.perception.hands import PALM, HandDetection, palm_length
from igrip.perception.hands._palms import measure_palm
from igrip.rgbd import RgbdFrame

pytest.importorskip("cv2", reason="hands are drawn by OpenCV")
HAND = draw_hand()


@given(
    u=st.floats(150, 500), v=st.floats(150, 330), depth=st.floats(0.4, 0.95),
    turn=st.floats(-3.1, 3.1),
)  # fmt: skip
def test_a_hand_is_where_it_was_put_and_as_large_as_there(u, v, depth, turn):
    frame, landmarks = paste_hand(desk(), HAND, (u, v), depth, turn)
    np.testing.assert_allclose(landmarks[list(PALM)].mean(axis=0), (u, v), atol=1e-9)
    np.testing.assert_allclose(palm_length(landmarks) * depth / CAMERA.fx, PALM_LENGTH)
    measured = measure_palm(HandDetection(landmarks, 1.0), frame)
    true = CAMERA.points(np.array([[u, v]]), np.array([depth]))[0]
    np.testing.assert_allclose(measured.position, true, atol=0.008)


def test_what_is_nearer_hides_it():
    empty = desk(depth=0.5)
    frame, _ = paste_hand(empty, HAND, (320.0, 240.0), 0.7)
    np.testing.assert_array_equal(frame.colour, empty.colour)
    np.testing.assert_array_equal(frame.depth, empty.depth)


def test_a_frame_without_depth_stays_without():
    empty = desk()
    frame, _ = paste_hand(RgbdFrame(0.0, empty.colour, None, CAMERA), HAND, (320.0, 240.0), 0.7)
    assert frame.depth is None
    assert (frame.colour != empty.colour).any()


def test_the_frame_itself_is_left_as_it_was():
    empty, again = desk(), desk()
    paste_hand(empty, HAND, (320.0, 240.0), 0.5)
    np.testing.assert_array_equal(empty.colour, again.colour)
    np.testing.assert_array_equal(empty.depth, again.depth)
