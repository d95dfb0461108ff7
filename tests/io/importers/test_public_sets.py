"""Public sets of hands that handle objects, on tiny hand-made files of the same layout."""

import os

import numpy as np
import pytest

from igrip.errors import DatasetError
from igrip.io.importers import ImportFiles, find_importer
from igrip.io.importers._handling import AFTER, MOVED, find_reaches, moves_of
from igrip.io.importers._mano import PALM, WRIST, palms
from igrip.io.takes.take import Track
from public_sets import (
    FRAMES,
    OTHER,
    PLACE,
    RATE,
    movement,
    write_dexycb,
    write_grab,
    write_hot3d,
)

MOVED_AT = 1.5 + MOVED / 0.2  # s: it is lifted with 0.2 m/s


def read(folder):
    importer = find_importer(ImportFiles([folder]))
    return importer, [one() for one in importer.reaches(ImportFiles([folder]))]


def check(found, hand, target, others):
    """Check that a reach is the movement that was written."""
    assert (found.hand, found.target) == (hand, target)
    assert set(found.moving_objects) == {target, *others}
    palms, _ = movement()
    count = len(found.times)
    begin = FRAMES - len(palms) + round((MOVED_AT + AFTER) * RATE) - count + 1
    assert begin >= 0
    np.testing.assert_allclose(found.positions, palms[begin : begin + count], atol=1e-6)
    assert found.seconds == pytest.approx(count / RATE - 1 / RATE)
    places = found.moving_objects[target].track.positions
    np.testing.assert_allclose(places[0], PLACE, atol=1e-6)
    for id in others:
        np.testing.assert_allclose(found.moving_objects[id].track.positions[0], OTHER, atol=1e-6)


def test_dexycb_is_read_in_the_frame_of_the_table(tmp_path):
    write_dexycb(tmp_path)
    importer, reaches = read(tmp_path)
    assert importer.name.startswith("DexYCB")
    [found] = reaches
    assert found.participant == "subject-01"
    assert found.models == {name: name for name in found.moving_objects}
    check(found, "right", "006_mustard_bottle", ["003_cracker_box"])
    turns = found.moving_objects["006_mustard_bottle"].track.orientations
    np.testing.assert_allclose(np.abs(turns[:, 3]), 1.0, atol=1e-6)  # upright on the table


def test_dexycb_without_its_calibration_is_named(tmp_path):
    write_dexycb(tmp_path)
    for path in (tmp_path / "calibration").rglob("*.yml"):
        path.unlink()
    with pytest.raises(DatasetError, match="20200709_141754: is no sequence of DexYCB"):
        read(tmp_path)


def test_hot3d_takes_the_hand_that_is_near(tmp_path):
    write_hot3d(tmp_path)
    importer, [found] = read(tmp_path)
    assert importer.name.startswith("HOT3D")
    assert found.participant == "P0001"
    assert set(found.other_hands) == {"left"}
    check(found, "right", "mug_white", ["bowl"])


def test_hot3d_that_is_damaged_is_named(tmp_path):
    sequence = write_hot3d(tmp_path)
    (sequence / "dynamic_objects.csv").write_text("object_uid,timestamp[ns]\n1,x\n")
    with pytest.raises(DatasetError, match="P0001_10a27bf7: is no sequence of HOT3D"):
        read(tmp_path)


def test_grab_has_one_object_and_palms_from_the_root(tmp_path):
    write_grab(tmp_path / "grab" / "s1" / "mug_drink_1.npz", lambda hand: hand - PALM)
    importer, [found] = read(tmp_path)
    assert importer.name.startswith("GRAB")
    assert found.participant == "s1"
    check(found, "right", "mug", [])


class Evil:
    def __reduce__(self):
        return os.system, ("touch /tmp/igrip-evil",)


def test_grab_runs_no_code_of_a_file(tmp_path):
    path = tmp_path / "grab" / "s1" / "mug_drink_1.npz"
    write_grab(path, lambda hand: hand - PALM, lhand={"params": Evil()})
    with pytest.raises(DatasetError, match="is not trusted"):
        read(tmp_path)
    assert not os.path.exists("/tmp/igrip-evil")


def test_nobody_who_moves_nothing_reaches(tmp_path):
    still = {"transl": np.tile(PLACE, (FRAMES, 1)), "global_orient": np.zeros((FRAMES, 3))}
    path = tmp_path / "grab" / "s1" / "mug_drink_1.npz"
    write_grab(path, lambda hand: hand - PALM, object={"params": still})
    with pytest.raises(DatasetError, match="nobody reaches for mug and moves it"):
        read(tmp_path)


def test_the_palm_turns_with_the_root_about_the_wrist():
    turn = np.array([[0.0, 0.0, np.pi / 2]])
    found = palms(np.zeros((1, 3)), turn, "right")[0]
    np.testing.assert_allclose(found, WRIST + [0.0, PALM[0] - WRIST[0], 0.0], atol=1e-12)
    mirrored = palms(np.zeros((1, 3)), np.zeros((1, 3)), "left")[0]
    np.testing.assert_allclose(mirrored, PALM * [-1, 1, 1])


def track(*places, rate=RATE):
    return Track(np.arange(len(places)) / rate, np.array(places, dtype=float))


def test_an_object_moves_once_it_had_rested():
    rest, away = [(0, 0, 0)] * 30, [(0.02 * k, 0, 0) for k in range(1, 16)]
    again = [(0.3, 0, 0)] * 30 + [(0.3, 0.05, 0)]
    found = list(moves_of(track(*rest, *away, *again)))
    assert found == pytest.approx([30 / RATE, 75 / RATE])
    assert list(moves_of(track(*away))) == []  # it moved all the time
    shaking = [(0.004 * (-1) ** k, 0, 0) for k in range(60)]
    assert list(moves_of(track(*shaking))) == []


def test_a_hand_far_away_took_nothing():
    hand = track(*[(2.0 + 0.01 * k, 0, 0) for k in range(60)])
    thing = track(*[(0, 0, 0)] * 40, *[(0.1, 0, 0)] * 20)
    assert find_reaches("x", "p", {"right": hand}, {"cup": thing}, {}) == []
