"""Headers of exports, with the variants that are around."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mocap_files as mocap
from igrip.errors import DatasetError
from igrip.io.table_files import read_table
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import open_file, read_take
from igrip.io.takes.roles import hands_of, objects_of
from mocap_files import Body, Scene

RANDOM = np.random.default_rng(5)
N = 40
HAND = np.cumsum(RANDOM.normal(0, 0.003, (N, 3)), axis=0) + [0.2, 0.1, 0.3]
HAND[10:15] = np.nan
TURNS = RANDOM.normal(size=(N, 4))
TURNS /= np.linalg.norm(TURNS, axis=1)[:, None]
MARKERS = Scene(np.arange(N) / 100, {"RHand": Body(HAND), "mug": Body(HAND + 0.2)})
RIGID = Scene(np.arange(N) / 100, {"RHand": Body(HAND, TURNS), "mug": Body(HAND + 0.2, TURNS)})


def take_of(path: Path, **declared):
    return read_take("take", open_file(path), Declared(**declared))


def assert_is_the_scene(take):
    seen = np.isfinite(HAND[:, 0])
    np.testing.assert_allclose(take.tracks["RHand"].positions, HAND[seen], atol=1e-7)
    np.testing.assert_allclose(take.tracks["mug"].positions, HAND[seen] + 0.2, atol=1e-7)
    np.testing.assert_allclose(take.tracks["RHand"].times, np.flatnonzero(seen) / 100, atol=1e-9)
    assert take.gaps == {"RHand": 5, "mug": 5}
    assert hands_of(take) == {"right": "RHand"}


def edited(path: Path, *changes: tuple[str, str]) -> Path:
    text = path.read_bytes().decode()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_bytes(text.encode())
    return path


# Motive ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", ["1.1", "1.2", "1.21", "1.22", "1.23", "1.24", "1.25"])
@pytest.mark.parametrize("unit", ["Meters", "Centimeters", "Millimeters"])
def test_motive(tmp_path, version, unit):
    path = mocap.motive(tmp_path / "t.csv", RIGID, version, unit, parent=version >= "1.24")
    take = take_of(path)
    assert_is_the_scene(take)
    assert take.layout == f"OptiTrack Motive CSV {version}"
    assert objects_of(take) == {"mug": "mug"}


def test_motive_without_a_blank_line_and_with_commas_at_the_ends(tmp_path):
    path = mocap.motive(tmp_path / "t.csv", RIGID)
    lines = path.read_text().splitlines()
    path.write_text("\n".join(line + ",,," for line in lines if line) + "\n")
    assert_is_the_scene(take_of(path))


def test_motive_with_timecode_and_unlabelled_markers(tmp_path):
    path = mocap.motive(tmp_path / "t.csv", MARKERS)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    added = {2: "Marker", 3: "Unlabeled 1234", 4: '"9F"', 5: "Position"}
    for k, row in enumerate(rows):
        if k < 2:
            continue
        row.insert(2, "TimeCode" if k == 6 else "" if k < 6 else "15:26:46:12.02")
        row += ["X", "Y", "Z"] if k == 6 else [added.get(k, "1.5")] * 3
    path.write_text("\n".join(",".join(row) for row in rows) + "\n")
    take = take_of(path)
    assert_is_the_scene(take)
    assert "1 markers without a label are left out" in take.remarks


def test_motive_prefers_where_a_marker_was_seen(tmp_path):
    path = mocap.motive(tmp_path / "t.csv", MARKERS)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    for k, row in enumerate(rows[2:], 2):
        solved = [cell.replace("Marker", "Rigid Body Marker") for cell in row[2:5]]
        row += ["77"] * 3 if k > 6 else solved
    path.write_text("\n".join(",".join(row) for row in rows) + "\n")
    assert_is_the_scene(take_of(path))


def test_motive_skeletons(tmp_path):
    bodies = {f"Anna:{name}": Body(HAND, TURNS) for name in ("Hip", "LHand", "RHand", "RThumb1")}
    path = mocap.motive(tmp_path / "t.csv", Scene(RIGID.times, bodies))
    edited(path, ("Rigid Body", "Bone"))
    take = take_of(path)
    assert hands_of(take) == {"left": "Anna:LHand", "right": "Anna:RHand"}
    assert objects_of(take) == {}


@pytest.mark.parametrize("lost", ["Frame,Time (Seconds)", "Position"])
def test_motive_without_a_row_that_it_needs(tmp_path, lost):
    path = edited(mocap.motive(tmp_path / "t.csv", MARKERS), (lost, "nothing"))
    with pytest.raises(DatasetError, match=r"t\.csv.*Motive"):
        take_of(path)


# QTM ----------------------------------------------------------------------------------------------


def test_qtm_names_with_blanks(tmp_path):
    path = edited(mocap.qtm_3d(tmp_path / "t.tsv", MARKERS), ("mug", "big mug"))
    assert set(take_of(path).tracks) == {"RHand", "big mug"}


@pytest.mark.parametrize("word", ["", "NULL", "NaN", "0.000"])
def test_qtm_lost_markers(tmp_path, word):
    path = mocap.qtm_3d(tmp_path / "t.tsv", MARKERS)
    rows = [line.split("\t") for line in path.read_text().splitlines()]
    filled = [
        "\t".join([c or word for c in row]) if row[0].isdigit() else "\t".join(row) for row in rows
    ]
    path.write_text("\n".join(filled) + "\n")
    assert_is_the_scene(take_of(path))


def test_qtm_6d_with_the_name_before_x_alone(tmp_path):
    path = mocap.qtm_6d(tmp_path / "t.tsv", RIGID, prefixed=False)
    first, second = ("RHand X\tY\tZ\tRoll", "mug X\tY\tZ\tRoll")
    text = path.read_text()
    place = text.index("\tX\tY\tZ\tRoll")
    text = text[:place] + f"\t{first}" + text[place + len("\tX\tY\tZ\tRoll") :]
    path.write_text(text.replace("\tX\tY\tZ\tRoll", f"\t{second}", 1))
    assert_is_the_scene(take_of(path))


def test_qtm_with_an_outer_clock(tmp_path):
    path = edited(mocap.qtm_3d(tmp_path / "t.tsv", MARKERS), ("FREQUENCY\t100", "FREQUENCY\tEXT"))
    assert_is_the_scene(take_of(path))


def test_qtm_without_any_header(tmp_path):
    take = take_of(mocap.qtm_3d(tmp_path / "t.tsv", MARKERS, header=False), length_unit="mm")
    assert_is_the_scene(take)


# Vicon --------------------------------------------------------------------------------------------


def test_vicon_with_several_sections(tmp_path):
    devices = (
        "Devices\n1000\n,,Force,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,1,2,3\n1,1,1,2,3\n\n"
    )
    trajectories = mocap.vicon(tmp_path / "a.csv", MARKERS).read_text()
    segments = mocap.vicon(
        tmp_path / "b.csv", Scene(RIGID.times, {"Mug": Body(HAND, TURNS)}), section="Segments"
    ).read_text()
    path = tmp_path / "t.csv"
    path.write_text(devices + trajectories + "\n" + segments)
    take = take_of(path)
    assert set(take.tracks) == {"RHand", "mug", "Mug"}
    assert take.tracks["Mug"].orientations is not None


def test_vicon_rotations_can_be_declared(tmp_path):
    path = mocap.vicon(tmp_path / "t.csv", RIGID, section="Segments")
    as_vector, as_angles = take_of(path), take_of(path, rotations="XYZ")
    ours, theirs = (take.tracks["mug"].orientations for take in (as_vector, as_angles))
    assert np.abs(np.sum(ours * theirs, axis=1)).min() < 0.9


def test_vicon_names_of_plug_in_gait(tmp_path):
    names = ("LFHD", "LWRA", "LFIN", "RSHO", "RWRB", "RFIN")
    path = mocap.vicon(tmp_path / "t.csv", Scene(RIGID.times, dict.fromkeys(names, Body(HAND))))
    assert hands_of(take_of(path)) == {"left": "LWRA", "right": "RWRB"}


# others -------------------------------------------------------------------------------------------


def test_trc_with_blanks_between_cells(tmp_path):
    whole = {"RHand": Body(np.nan_to_num(HAND, nan=0.5)), "mug": Body(TURNS[:, :3])}
    path = mocap.trc(tmp_path / "t.trc", Scene(RIGID.times, whole))
    rows = path.read_text().splitlines()
    path.write_text("\n".join([*rows[:6], *("  ".join(row.split()) for row in rows[6:])]) + "\n")
    found = take_of(path).tracks["mug"].positions
    np.testing.assert_allclose(found, TURNS[:, :3], atol=1e-9)


def test_bids_without_its_channels_or_with_too_few(tmp_path):
    path = mocap.motion_bids(tmp_path, RIGID)
    channels = next(tmp_path.glob("*_channels.tsv"))
    text = channels.read_text()
    channels.write_text(text.rsplit("\n", 2)[0] + "\n")
    with pytest.raises(DatasetError, match=r"has 14 columns, .*channels\.tsv names 13"):
        take_of(path)


def test_c3d_that_is_cut(tmp_path):
    path = mocap.c3d(tmp_path / "t.c3d", MARKERS)
    path.write_bytes(path.read_bytes()[:-900])
    with pytest.raises(DatasetError, match=r"t\.c3d: is cut off"):
        take_of(path)


# plain tables -------------------------------------------------------------------------------------

NAMED = [
    "time,right_x,right_y,right_z,mug_x,mug_y,mug_z",
    "Time (ms),right X (mm),right Y (mm),right Z (mm),mug X (mm),mug Y (mm),mug Z (mm)",
    "timestamp_ms,x_right,y_right,z_right,x_mug,y_mug,z_mug",
    "t,right.x,right.y,right.z,mug.x,mug.y,mug.z",
    "t,right pos x,right pos y,right pos z,mug pos x,mug pos y,mug pos z",
    "t,rightTX,rightTY,rightTZ,mugTX,mugTY,mugTZ",
    "Zeit,pos_x_right,pos_y_right,pos_z_right,position.x.mug,position.y.mug,position.z.mug",
    "Temps,right[x],right[y],right[z],mug[x],mug[y],mug[z]",
    "host_time,right (X),right (Y),right (Z),mug (X),mug (Y),mug (Z)",
    "relative time,right_px,right_py,right_pz,mug_px,mug_py,mug_pz",
    "time,right (X) [mm],right (Y) [mm],right (Z) [mm],mug (X) [mm],mug (Y) [mm],mug (Z) [mm]",
    "t,right X (in),right Y (in),right Z (in),mug X (in),mug Y (in),mug Z (in)",
    "% t,right_x,right_y,right_z,mug_x,mug_y,mug_z",
]
UNIT_WORDS = {"(mm)": "mm", "[mm]": "mm", "(in)": "in"}


@pytest.mark.parametrize("header", NAMED)
def test_bodies_by_the_names_of_columns(tmp_path, header):
    rows = [header] + [f"{10 * k},{k},2,3,4,5,6" for k in range(20)]
    (tmp_path / "t.csv").write_text("\n".join(rows))
    layout = read_table(tmp_path / "t.csv").layout
    assert [body.name for body in layout.bodies] == ["right", "mug"]
    assert [body.position for body in layout.bodies] == [(1, 2, 3), (4, 5, 6)]
    assert layout.time == 0
    assert layout.time_unit == ("ms" if "ms" in header else None)
    assert layout.length_unit == next((u for word, u in UNIT_WORDS.items() if word in header), None)


@pytest.mark.parametrize(
    "header", ["index,matrix,apex", "a,b,c", "trial,hand,target", "stopx,stopy,stopz", "px,ix,z_px"]
)
def test_names_that_are_no_coordinates(tmp_path, header):
    (tmp_path / "t.csv").write_text(header + "\n" + "\n".join(f"{k},2,3" for k in range(9)))
    assert read_table(tmp_path / "t.csv").layout.bodies == ()


def test_quaternions_by_the_names_of_columns(tmp_path):
    header = "t,hand_x,hand_y,hand_z,hand_qw,hand_qx,hand_qy,hand_qz"
    (tmp_path / "t.csv").write_text(
        header + "\n" + "\n".join(f"{k},1,2,3,1,0,0,0" for k in range(9))
    )
    take = take_of(tmp_path / "t.csv")
    assert take.tracks["hand"].orientations[0] == pytest.approx([0, 0, 0, 1])


@pytest.mark.parametrize("version", ["1.2", "1.23", "1.25"])
def test_motive_without_its_first_line(tmp_path, version):
    path = mocap.motive(tmp_path / "t.csv", RIGID, version, parent=version >= "1.24")
    rows = path.read_text().splitlines()
    path.write_text("\n".join(rows[1:]))
    assert_is_the_scene(take := take_of(path, length_unit="mm"))
    assert "first line" in take.remarks[0]


def test_a_row_between_blanks_with_empty_cells_is_left_out(tmp_path):
    mug = HAND + 0.2
    scene = Scene(MARKERS.times, {"RHand": Body(HAND), "mug": Body(np.nan_to_num(mug, nan=0.3))})
    path = mocap.trc(tmp_path / "t.trc", scene)
    head, rows = path.read_text().split("\n\n", 1)
    path.write_text(head + "\n\n" + rows.replace("\t", " "))
    take = take_of(path)
    seen = np.isfinite(HAND[:, 0])
    np.testing.assert_allclose(take.tracks["RHand"].positions, HAND[seen], atol=1e-7)
    np.testing.assert_allclose(take.tracks["mug"].positions, mug[seen], atol=1e-7)
    assert "5 rows without a time left out" in take.remarks[0]


@pytest.mark.parametrize("section", ["Segments", "Objects"])
@pytest.mark.parametrize("degrees", [True, False])
def test_vicon_rotations_longer_than_half_a_turn_are_angles(tmp_path, section, degrees):
    turns = Rotation.from_euler("XYZ", np.linspace([100, -60, -170], [150, 40, 170], N), True)
    scene = Scene(MARKERS.times, {"mug": Body(HAND, turns.as_quat())})
    path = mocap.vicon(tmp_path / "t.csv", scene, section=section)
    take = take_of(path)  # axis times angle is not touched
    assert "axis times angle" in take.remarks[0]
    seen = np.isfinite(HAND[:, 0])
    assert_turns(take.tracks["mug"], turns[seen])
    rows = path.read_text().splitlines()
    angles = turns.as_euler("XYZ", degrees=degrees)
    for k in np.flatnonzero(seen):
        cells = rows[5 + k].split(",")
        rows[5 + k] = ",".join([*cells[:2], *map(str, angles[k]), *cells[5:]])
    text = "\n".join(rows)
    path.write_text(text if degrees else text.replace("deg", "rad"))
    take = take_of(path)
    assert "exceed half a turn" in take.remarks[0]
    assert_turns(take.tracks["mug"], turns[seen])


def assert_turns(track, turns):
    apart = Rotation.from_quat(track.orientations) * turns.inv()
    assert apart.magnitude().max() < 1e-6
