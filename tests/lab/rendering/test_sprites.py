"""Hands put into frames: where they were put, as large as they should be, behind what is nearer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hands import CAMERA, desk, find_hands_or_skip
from igrip.errors import IgripError
from igrip.lab.rendering.sprites import LENGTH, draw_hand, film_sprites, place
from igrip.perception.hand_detection.image_tiles import PALM, palm_length
from igrip.perception.hand_detection.palms import measure_palm
from igrip.rgbd import RgbdFrame

pytest.importorskip("cv2", reason="sprites are made by OpenCV")
HAND = draw_hand()


@given(
    u=st.floats(150, 500), v=st.floats(150, 330), depth=st.floats(0.4, 0.95),
    turn=st.floats(-3.1, 3.1),
)  # fmt: skip
def test_a_hand_is_where_it_was_put_and_as_large_as_there(u, v, depth, turn):
    frame, hand = place(desk(), HAND, (u, v), depth, turn)
    np.testing.assert_allclose(hand.landmarks[list(PALM)].mean(axis=0), (u, v), atol=1e-9)
    np.testing.assert_allclose(palm_length(hand.landmarks) * depth / CAMERA.fx, LENGTH)
    measured = measure_palm(hand, frame)
    true = CAMERA.points(np.array([[u, v]]), np.array([depth]))[0]
    np.testing.assert_allclose(measured.position, true, atol=0.008)


def test_what_is_nearer_hides_it():
    empty = desk(depth=0.5)
    frame, _ = place(empty, HAND, (320.0, 240.0), 0.7)
    np.testing.assert_array_equal(frame.colour, empty.colour)
    np.testing.assert_array_equal(frame.depth, empty.depth)


def test_a_frame_without_depth_stays_without():
    empty = desk()
    frame, _ = place(RgbdFrame(0.0, empty.colour, None, CAMERA), HAND, (320.0, 240.0), 0.7)
    assert frame.depth is None
    assert (frame.colour != empty.colour).any()


def test_the_frame_itself_is_left_as_it_was():
    empty, again = desk(), desk()
    place(empty, HAND, (320.0, 240.0), 0.5)
    np.testing.assert_array_equal(empty.colour, again.colour)
    np.testing.assert_array_equal(empty.depth, again.depth)


def test_a_real_hand_is_cut_out_whole(shared_data):
    finder = find_hands_or_skip(hands=1)
    film = film_sprites(shared_data / "images" / "hand_720p.mp4", finder, every=20)
    sprite = next(film)
    height, width = sprite.alpha.shape
    u, v = np.clip(np.round(sprite.landmarks).astype(int), 0, [width - 1, height - 1]).T
    assert sprite.alpha[v, u].mean() > 0.95  # the landmarks are on it
    assert 0.1 < (sprite.alpha > 0.5).mean() < 0.6
    found = []
    for k in range(5):
        frame, truth = place(desk(), sprite, (300.0, 230.0), 0.6)
        found = finder.find(RgbdFrame(k / 30, frame.colour, None, CAMERA, "desk"))
    assert len(found) == 1
    off = found[0].landmarks[list(PALM)] - truth.landmarks[list(PALM)]
    assert np.linalg.norm(off.mean(axis=0)) < 0.15 * palm_length(truth.landmarks)
    finder.close()


def test_what_is_no_film_is_refused(tmp_path):
    (tmp_path / "no.mp4").write_bytes(b"no film")
    with pytest.raises(IgripError, match="no film"):
        list(film_sprites(tmp_path / "no.mp4", None))
