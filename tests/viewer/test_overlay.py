"""The picture with what is seen and decided: where things are drawn, and in which colour."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.intention import Intention
from igrip.rgbd import Intrinsics, RgbdFrame
from igrip.viewer.overlay import Box, CameraView, draw_overlay, outline_of, place_boxes
from igrip.viewer.palette import INK, colour_of, rgb
from support import BOX, placed

SIZE = (640, 480)
CAMERA = Intrinsics(*SIZE, 500.0, 500.0, 319.5, 239.5)


def frame(world_from_camera=None):
    picture = np.full((SIZE[1], SIZE[0], 3), 128, np.uint8)
    where = np.eye(4) if world_from_camera is None else world_from_camera
    return RgbdFrame(0.0, picture, None, CAMERA, world_from_camera=where)


def box(shapes, at, id="thing"):
    return placed(shapes[BOX], id, np.eye(3), np.asarray(at, float))


def test_an_outline_is_the_projection_of_the_corners(shapes):
    thing = box(shapes, (0.0, 0.0, 1.0))
    outline = outline_of(frame(), thing)
    x, y, z = thing.model.vertices.max(axis=0)
    nearest = 1.0 - z
    expected = [319.5 + 500.0 * x / nearest, 239.5 + 500.0 * y / nearest]
    assert outline.max(axis=0) == pytest.approx(expected, abs=1e-6)


def test_what_is_behind_the_camera_or_beside_the_picture_has_none(shapes):
    assert outline_of(frame(), box(shapes, (0.0, 0.0, -1.0))) is None
    assert outline_of(frame(), box(shapes, (0.0, 0.0, 0.05))) is None
    assert outline_of(frame(), box(shapes, (9.0, 0.0, 1.0))) is None


def test_the_camera_may_stand_anywhere(shapes):
    shift = np.eye(4)
    shift[:3, 3] = (1.0, 2.0, 3.0)
    there = outline_of(frame(shift), box(shapes, (1.0, 2.0, 4.0)))
    here = outline_of(frame(), box(shapes, (0.0, 0.0, 1.0)))
    assert there == pytest.approx(here)


def pixels(picture, colour, near=30):
    return int((np.abs(picture.astype(int) - rgb(colour)).sum(axis=2) < near).sum())


def reaching(none):
    return Intention(
        t=0.0, hand="right", status="reaching", target="thing", grip="palmar",
        probability={"thing": 1.0 - none, "none": none},
    )  # fmt: skip


def test_a_target_has_a_dark_outline_around_its_own_colour(shapes):
    thing = box(shapes, (0.0, 0.0, 1.0))
    plain = draw_overlay(CameraView(frame(), {}, [thing], []))
    assert plain.shape == (480, 640, 3)
    assert pixels(plain, colour_of(0)) > 100
    words = pixels(plain, INK)  # its name
    assert words < 300
    chosen = draw_overlay(CameraView(frame(), {}, [thing], [reaching(none=0.1)]))
    assert pixels(chosen, colour_of(0)) > 100
    assert pixels(chosen, INK) > words + 300
    undecided = draw_overlay(CameraView(frame(), {}, [thing], [reaching(none=0.9)]))
    assert pixels(undecided, INK) == words
    idle = Intention(t=0.0, hand="right", status="idle", target="thing", grip="palmar")
    assert pixels(draw_overlay(CameraView(frame(), {}, [thing], [idle])), INK) == words


def test_an_object_has_the_colour_of_its_number(shapes):
    thing = box(shapes, (0.0, 0.0, 1.0))
    third = draw_overlay(CameraView(frame(), {}, [thing], []), looks={"thing": 2})
    assert pixels(third, colour_of(2)) > 100
    assert pixels(third, colour_of(0)) == 0


def test_words_stay_within_the_picture_whatever_they_are(shapes):
    thing = box(shapes, (0.55, -0.4, 1.0), id="ein sehr langer Name ✋" * 4)
    points = {"camera/left": np.full((21, 2), 1000.0)}
    said = Intention(t=0.0, hand="camera/left", status="lost", reason="x" * 300)
    assert draw_overlay(CameraView(frame(), points, [thing], [said]), width=320).shape == (
        240,
        320,
        3,
    )


def box_from(left, top, wide, high):
    return Box(left, top, left + wide, top + high)


BOXES = st.lists(
    st.builds(box_from, st.integers(-99, 699), st.integers(-99, 499), st.integers(1, 600),
              st.integers(10, 30)), max_size=7,
)  # fmt: skip


@given(BOXES)
def test_labels_are_in_the_picture_and_cover_no_other(boxes):
    """Seven lines of 30 pixels always find room in 480."""
    placed = place_boxes(boxes, *SIZE)
    picture = np.zeros((SIZE[1], SIZE[0]), int)
    for before, after in zip(boxes, placed, strict=True):
        assert after.right - after.left == before.right - before.left
        assert after.bottom - after.top == before.bottom - before.top
        assert min(after) >= 0
        picture[after.top : after.bottom, after.left : after.right] += 1
    assert picture.sum() == sum((b.right - b.left) * (b.bottom - b.top) for b in boxes)
    assert picture.max(initial=0) <= 1


def test_labels_without_room_stay_in_the_picture():
    boxes = [box_from(0, 0, 100, 60), box_from(0, 0, 100, 60)]
    assert place_boxes(boxes, 100, 100) == [Box(0, 0, 100, 60), Box(0, 0, 100, 60)]


def test_labels_with_room_stay_where_they_are():
    boxes = [box_from(10 * k, 40 * k, 300, 30) for k in range(7)]
    assert place_boxes(boxes, *SIZE) == boxes
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))
