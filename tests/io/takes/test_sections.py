"""Sections of Vicon files and tracking systems of Motion-BIDS that recorded at different rates."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

import mocap_files as mocap
from igrip import load_objects
from igrip.io.column_map import read_column_map
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles
from igrip.io.importers.motion_capture import MotionCapture
from igrip.io.inspection import inspect_files
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.recordings import open_source
from igrip.io.resampling import ImportOptions
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import open_file, read_take
from mocap_files import Body, Scene

MAP = """
[samples]
body = "RightHand"
[trials]
hand = "=right"
target = "=mug"
[objects.mug]
body = "mug"
model = "006_mustard_bottle"
"""


def course(times):
    """Return where the hand and the mug are at some times, shape (n, 3) each."""
    hand = np.column_stack([0.2 - 0.15 * times, 0.1 + 0.1 * times, 0.1 + 0.02 * np.sin(3 * times)])
    return hand, np.column_stack([0.05 * times, 0.4 + 0.0 * times, 0.06 + 0.01 * times])


def scene(name: str, rate: float, seconds: float = 2.0, begin: float = 0.0) -> Scene:
    times = np.arange(round(begin * rate), round((begin + seconds) * rate)) / rate
    positions = course(times)[name == "mug"]
    upright = np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1))
    return Scene(times, {name: Body(positions, upright)}, rate)


def vicon(path: Path, *sections: tuple[str, Scene]) -> Path:
    texts = [mocap.vicon(path, one, section=title).read_text() for title, one in sections]
    path.write_text("\n".join(texts))
    return path


def assert_both_move(take, begin=0.0):
    for index, name in enumerate(("RightHand", "mug")):
        track = take.tracks[name]
        np.testing.assert_allclose(track.positions, course(track.times + begin)[index], atol=1e-6)


DEVICES = "Devices\n1000\n,,Plate,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n" + "".join(
    f"{k // 10 + 1},{k % 10},{k},1,2\n" for k in range(2000)
)
EVENTS = "Events\n100\nSubject,Context,Name,Time (s),Description\nAnna,Right,Go,0.5,x\n"


@pytest.mark.parametrize("rate", [25.0, 50.0, 120.0])
@pytest.mark.parametrize("hand_first", [True, False])
def test_vicon_sections_at_their_own_rates(tmp_path, rate, hand_first):
    sections = [("Trajectories", scene("RightHand", 100.0)), ("Objects", scene("mug", rate))]
    path = vicon(tmp_path / "t.csv", *(sections if hand_first else sections[::-1]))
    take = read_take("t", open_file(path), Declared())
    assert_both_move(take)
    assert len(take.tracks["RightHand"].times) == 200
    assert len(take.tracks["mug"].times) == 2 * rate
    assert "samples a second" in " ".join(take.remarks)


@pytest.mark.parametrize("other", [EVENTS, DEVICES, EVENTS + "\n" + DEVICES])
@pytest.mark.parametrize("before", [True, False])
def test_vicon_sections_without_positions(tmp_path, other, before):
    path = vicon(tmp_path / "t.csv", ("Segments", scene("RightHand", 100.0)),
                 ("Segments", scene("mug", 100.0)))  # fmt: skip
    text = path.read_text()
    path.write_text(f"{other}\n{text}" if before else f"{text}\n{other}")
    assert_both_move(read_take("t", open_file(path), Declared()))


def imported(folder: Path, out: Path, importer):
    problems: list[str] = []
    dataset = import_dataset(
        importer, importer.reaches(ImportFiles([folder])), out, load_objects("ycb"),
        ImportOptions(), ["ycb"], problems,
    )  # fmt: skip
    assert not problems
    return list(open_source(dataset.recording(dataset.trials[0])))


def assert_is_imported(messages):
    assert len(messages) > 50
    for message in messages[:-1]:
        hand, _ = course(np.array([message.t]))
        assert message.hands["right"].position == pytest.approx(hand[0], abs=1e-4)
        assert message.objects["mug"] is not None
    mug = np.array([message.objects["mug"].position for message in messages[:-1]])
    times = np.array([message.t for message in messages[:-1]])
    np.testing.assert_allclose(mug - mug[0], course(times)[1] - course(times)[1][0], atol=1e-4)


@pytest.mark.parametrize("rate", [25.0, 100.0, 120.0])
def test_a_map_finds_the_bodies_of_every_section(tmp_path, rate):
    folder = tmp_path / "in"
    folder.mkdir()
    vicon(folder / "t.csv", ("Trajectories", scene("RightHand", 100.0)),
          ("Objects", scene("mug", rate)))  # fmt: skip
    (folder / "map.toml").write_text(MAP)
    importer = ColumnMapImporter(read_column_map(folder / "map.toml"))
    assert_is_imported(imported(folder, tmp_path / "out", importer))


def two_systems(folder: Path, rate: float, inherited: bool = False) -> Path:
    stem = "sub-01_task-reach_tracksys-{}_run-01"
    mocap.motion_bids(folder, scene("RightHand", 100.0), stem.format("hand"))
    mocap.motion_bids(folder, scene("mug", rate), stem.format("objects"))
    imu = folder / f"{stem.format('imu')}_channels.tsv"
    imu.write_text("name\tcomponent\ttype\ttracked_point\tunits\nax\tx\tACCEL\twrist\tm/s^2\n")
    (folder / f"{stem.format('imu')}_motion.json").write_text('{"SamplingFrequency": 200}')
    (folder / f"{stem.format('imu')}_motion.tsv").write_text("9.8\n" * 400)
    if inherited:  # what holds for all runs stands above
        for name in ("hand", "objects", "imu"):
            for ending in ("_channels.tsv", "_motion.json"):
                above = folder.parent.parent / f"task-reach_tracksys-{name}{ending}"
                shutil.move(folder / f"{stem.format(name)}{ending}", above)
    return folder


@pytest.mark.parametrize("rate", [50.0, 100.0, 144.0])
@pytest.mark.parametrize("inherited", [False, True])
@pytest.mark.parametrize("mapped", [False, True])
def test_several_tracking_systems_are_one_take(tmp_path, rate, inherited, mapped):
    folder = tmp_path / "bids" / "sub-01" / "motion"
    two_systems(folder, rate, inherited)
    importer = MotionCapture()
    if mapped:
        (tmp_path / "map.toml").write_text(MAP)
        importer = ColumnMapImporter(read_column_map(tmp_path / "map.toml"))
    assert_is_imported(imported(tmp_path / "bids", tmp_path / "out", importer))


def test_an_inspection_shows_one_take(tmp_path):
    two_systems(tmp_path / "motion", 50.0)
    moving = [one for one in inspect_files([tmp_path], Declared()) if one.take is not None]
    assert [sorted(one.take.tracks) for one in moving] == [["RightHand", "mug"]]
