"""Tables in long format against the same recording written with columns for each body."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from igrip.errors import DatasetError
from igrip.io.importers import ImportFiles
from igrip.io.importers.motion_capture import MotionCapture
from igrip.io.table_files import read_table
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import read_take
from igrip.io.takes.take import Take

TIMES = np.arange(120) / 60.0
PATHS = {
    "right_hand": np.stack([0.2 * TIMES, 0.1 + 0.1 * TIMES, 0.05 + 0.02 * TIMES], axis=1),
    "mug": np.tile([0.3, 0.4, 0.05], (len(TIMES), 1)),
    "bowl": np.tile([-0.2, 0.4, 0.04], (len(TIMES), 1)),
}


def rows_of(name: str, shift: float = 0.0, every: int = 1) -> list[tuple[float, str]]:
    return [
        (t + shift, f"{t + shift:.6f},{name},{x:.9f},{y:.9f},{z:.9f}")
        for t, (x, y, z) in zip(TIMES[::every], PATHS[name][::every], strict=True)
    ]


def written(path: Path, rows: list[str], head: str = "time,name,x,y,z") -> Path:
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def take_of(path: Path, declared: Declared | None = None) -> Take:
    return read_take(path.stem, read_table(path), declared or Declared())


def assert_as_recorded(take: Take, names: dict[str, str] | None = None) -> None:
    names = names or {name: name for name in PATHS}
    assert set(take.tracks) == set(names)
    for key, name in names.items():
        assert_allclose(take.tracks[key].positions, PATHS[name], atol=1e-6)
        assert_allclose(take.tracks[key].times, TIMES, atol=1e-6)
        assert not len(take.tracks[key].lost)


@pytest.mark.parametrize("order", ["by time", "by body", "at random"])
def test_bodies_that_share_their_times(tmp_path: Path, order: str) -> None:
    rows = [row for name in PATHS for row in rows_of(name)]
    if order == "by time":
        rows.sort(key=lambda row: row[0])
    elif order == "at random":
        rows = [rows[k] for k in np.random.default_rng(1).permutation(len(rows))]
    assert_as_recorded(take_of(written(tmp_path / "long.csv", [text for _, text in rows])))


@pytest.mark.parametrize("heading", ["Body", "object_name", "Marker ID", "joint", "tracker"])
def test_other_headings_and_more_columns(tmp_path: Path, heading: str) -> None:
    rows = [f"{text},{k % 3 == 0},0.9" for k, (_, text) in enumerate(sorted(
        row for name in PATHS for row in rows_of(name)
    ))]  # fmt: skip
    head = f"time,{heading},x,y,z,seen,confidence"
    assert_as_recorded(take_of(written(tmp_path / "long.csv", rows, head)))


def test_frames_and_numbers_as_names(tmp_path: Path) -> None:
    rows = [
        f"{k},{number},{1000 * x:.6f},{1000 * y:.6f},{1000 * z:.6f}"
        for k in range(len(TIMES))
        for number, name in enumerate(PATHS, 1)
        for x, y, z in [PATHS[name][k]]
    ]
    path = written(tmp_path / "long.csv", rows, "frame,marker_id,x_mm,y_mm,z_mm")
    names = {f"marker_id {number}": name for number, name in enumerate(PATHS, 1)}
    assert_as_recorded(take_of(path, Declared(rate=60.0)), names)


def test_rotations_are_kept(tmp_path: Path) -> None:
    rows = [f"{text},0,0,0.6,0.8" for _, text in sorted(rows_of("mug") + rows_of("bowl"))]
    path = written(tmp_path / "long.csv", rows, "t,object,px,py,pz,qx,qy,qz,qw".replace("p", ""))
    turns = take_of(path).tracks["mug"].orientations
    assert turns is not None
    assert_allclose(turns, np.tile([0.0, 0.0, 0.6, 0.8], (len(TIMES), 1)), atol=1e-9)


def test_a_body_that_is_not_there_for_a_while_is_lost(tmp_path: Path) -> None:
    rows = sorted(rows_of("right_hand") + rows_of("mug"))
    rows = [row for row in rows if not (0.5 <= row[0] < 1.0 and "hand" in row[1])]
    track = take_of(written(tmp_path / "long.csv", [text for _, text in rows])).tracks["right_hand"]
    assert len(track.times) == len(TIMES) - 30
    assert_allclose(track.lost, TIMES[30:60], atol=1e-6)


def test_bodies_with_times_of_their_own_lose_nothing(tmp_path: Path) -> None:
    rows = sorted(rows_of("right_hand") + rows_of("mug", shift=0.004, every=3))
    take = take_of(written(tmp_path / "long.csv", [text for _, text in rows]))
    assert len(take.tracks["right_hand"].times) == len(TIMES)
    mug = take.tracks["mug"]
    assert_allclose(mug.times, TIMES[::3] + 0.004, atol=1e-6)
    assert not len(take.tracks["right_hand"].lost)
    assert not len(mug.lost)


def test_a_column_of_trials_separates_them(tmp_path: Path) -> None:
    rows = [f"{trial},{text}" for trial in (3, 7) for _, text in sorted(
        row for name in PATHS for row in rows_of(name)
    )]  # fmt: skip
    path = written(tmp_path / "long.csv", rows, "Trial,time,name,x,y,z")
    reaches = [read() for read in MotionCapture().reaches(ImportFiles([path]))]
    assert [reach.trial for reach in reaches] == ["3", "7"]
    for reach in reaches:
        assert_allclose(reach.positions, PATHS["right_hand"], atol=1e-6)
        assert set(reach.moving_objects) == {"mug", "bowl"}


def test_takes_one_after_the_other_without_a_column_of_trials_are_refused(tmp_path: Path) -> None:
    rows = [text for _ in range(3) for _, text in sorted(rows_of("mug") + rows_of("bowl"))]
    with pytest.raises(DatasetError, match="several rows hold the same body at the same time"):
        read_table(written(tmp_path / "long.csv", rows))


def test_a_name_that_never_changes_is_no_long_format(tmp_path: Path) -> None:
    path = written(tmp_path / "one.csv", [text for _, text in rows_of("mug")])
    assert read_table(path).columns == ("time", "name", "x", "y", "z")
