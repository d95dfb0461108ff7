"""Square tiles: where their pixels are in the picture, what they cover, what is one hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.lab.rendering.drawn_hand import OPEN_HAND
from igrip.perception.hands import HandDetection
from igrip.perception.hands._image_tiles import (
    TURNS,
    Tile,
    distinct,
    is_stump,
    paint_over,
    same_hand,
    search_tiles,
    upright_tiles,
)
from igrip.rgbd import Intrinsics

pytest.importorskip("cv2", reason="tiles are made by OpenCV")


@given(
    x=st.floats(150, 450), y=st.floats(120, 280), side=st.floats(100, 700),
    turn=st.sampled_from(TURNS),
)  # fmt: skip
def test_a_spot_is_where_the_tile_says(x, y, side, turn):
    picture = np.zeros((400, 600, 3), np.uint8)
    spot = np.array([round(x) + 10, round(y) - 5])
    picture[spot[1] - 3 : spot[1] + 4, spot[0] - 3 : spot[0] + 4] = 255
    pixels, back = Tile(x, y, side, turn).render(picture, [])
    assert pixels.shape[0] == pixels.shape[1]
    weights = pixels[..., 0].astype(float)
    vs, us = np.indices(weights.shape)
    found = np.array([(us * weights).sum(), (vs * weights).sum()]) / weights.sum()
    np.testing.assert_allclose(back[:, :2] @ found + back[:, 2], spot, atol=0.5)


@pytest.mark.parametrize("size", [(1280, 720), (640, 400), (480, 640), (500, 500), (2000, 300)])
def test_tiles_cover_the_whole_picture(size):
    camera = Intrinsics(*size, 500.0, 500.0, 0.0, 0.0)
    seen = np.zeros(size, bool)
    for tile in upright_tiles(camera):
        assert tile.side == min(size)
        x, y, half = round(tile.x), round(tile.y), round(tile.side / 2)
        assert x >= half - 1
        assert y >= half - 1
        seen[x - half : x + half, y - half : y + half] = True
    assert seen.mean() > 0.99


def hand(at, length=80.0, turn=0.0, score=0.9):
    c, s = np.cos(turn), np.sin(turn)
    return HandDetection(np.array(at) + length * OPEN_HAND @ np.array([[c, s], [-s, c]]), score)


def test_a_search_looks_beside_the_known_hands_and_everywhere():
    camera = Intrinsics(1280, 720, 900.0, 900.0, 640.0, 360.0)
    known = hand((300, 400))
    tiles = search_tiles(camera, [known])
    assert {tile.turn for tile in tiles} == set(TURNS)
    assert set(upright_tiles(camera)) <= set(tiles)
    assert tiles[0].holds(known.landmarks)


def test_two_finds_at_one_place_are_one_hand():
    one, again = hand((300, 400)), hand((310, 405), score=0.5)
    beside = hand((400, 400))
    assert distinct([one, again, beside]) == [one, beside]


@given(turn=st.floats(-3.2, 3.2), scale=st.floats(0.2, 5.0))
def test_what_is_one_hand_is_so_at_any_size_and_turn(turn, scale):
    c, s = scale * np.cos(turn), scale * np.sin(turn)
    turned = np.array([[c, s], [-s, c]])
    one, near, far = (hand(at).landmarks @ turned for at in ((0, 0), (20, 10), (90, 0)))
    assert same_hand(one, near)
    assert not same_hand(one, far)


def test_clasped_hands_are_two_and_an_arm_is_none():
    one = hand((300, 400)).landmarks
    clasped = hand((390, 340), turn=-np.pi / 2).landmarks  # from the right
    assert not is_stump(clasped, one)
    assert not same_hand(clasped, one)
    stump = hand((305, 440), length=40.0).landmarks  # below the wrist, fingers up
    assert is_stump(stump, one)


def test_a_covered_hand_is_gone():
    picture = np.full((500, 600, 3), 90, np.uint8)
    known = hand((300, 400)).landmarks
    for x, y in known.astype(int):
        picture[y - 4 : y + 5, x - 4 : x + 5] = 250
    assert (paint_over(picture, [known]) == 90).all()
    assert (picture == 250).any()  # the picture itself is left as it was
