"""What stands on the table: nothing, one, several, one at the picture's edge, a hand at it."""

import numpy as np
import pytest
import trimesh

from igrip.lab.rendering.drawn_hand import draw_hand, paste_hand
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.model import build_model
from igrip.perception.registration.table import Table
from igrip.perception.scan.find import CUT, NOTHING, Sighting, Unseen, find_thing
from standing import CAMERA, standing

BOX = build_model("plain box", trimesh.creation.box((0.12, 0.06, 0.1)))
CAN = build_model("plain can", trimesh.creation.cylinder(0.035, 0.11, sections=64))
DISC = build_model("plain disc", trimesh.creation.cylinder(0.1, 0.025, sections=64))
REACH = (0.2, 1.5)


def seen(*placed, hand=None, stand=0.0):
    scene = RenderedScene({str(k): one for k, one in enumerate(placed)}, CAMERA)
    random = np.random.default_rng(0)
    frame = scene.frame(0.0, random)
    table = Table()
    assert table.update(frame, REACH, random, False)
    landmarks = []
    if hand is not None:
        frame, found = paste_hand(frame, draw_hand(), hand, 0.6)
        landmarks = [found]
    return find_thing(frame, table.plane, landmarks, REACH, stand, 0.004)


def test_one_thing_is_found_with_its_size():
    found = seen(standing(BOX, 0.0, 0.0))
    assert isinstance(found, Sighting)
    assert np.percentile(found.points[:, 2], 98) == pytest.approx(0.1, abs=0.006)
    rows, columns = found.box
    assert 40 < rows.stop - rows.start < 200
    assert 40 < columns.stop - columns.start < 200


def test_an_empty_table_and_several_things_are_told_apart():
    assert seen() == Unseen(NOTHING)
    two = seen(standing(BOX, -0.1, 0.0), standing(CAN, 0.12, 0.0))
    assert two.problem == "2 things stand on the table: leave only the one to be scanned"


def test_what_the_edge_of_the_picture_cuts_is_refused():
    assert seen(standing(BOX, 0.42, 0.0)) == Unseen(CUT)


def test_a_hand_at_the_thing_is_no_problem_but_nothing_is_seen():
    scene = RenderedScene({"box": standing(BOX, 0.0, 0.0)}, CAMERA)
    middle = np.linalg.inv(CAMERA) @ [0.0, 0.0, 0.06, 1.0]
    x, y = scene.intrinsics.pixels(middle[None, :3])[0]
    assert seen(standing(BOX, 0.0, 0.0), hand=(x + 30, y)) == Unseen(None)


def test_a_turntable_is_left_out():
    disc = standing(DISC, 0.0, 0.0)
    box = standing(BOX, 0.0, 0.0)
    box.pose[2, 3] += 0.025
    alone = seen(disc, box, stand=0.025)
    assert isinstance(alone, Sighting)
    assert np.ptp(alone.points[:, :2], axis=0).max() < 0.14
    assert np.percentile(alone.points[:, 2], 98) == pytest.approx(0.1, abs=0.008)
    with_disc = seen(disc, box)
    assert np.ptp(with_disc.points[:, :2], axis=0).max() > 0.17
