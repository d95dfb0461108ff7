"""What people bring: each kind of table does what its user expects."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

import plain_tables as plain
from igrip import load_objects
from igrip.errors import DatasetError
from igrip.io.column_map import read_column_map
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.recordings import open_source
from igrip.io.resampling import ImportOptions
from igrip.io.takes.declared import Declared

SHARED = Path(__file__).parents[3] / "shared" / "inputs"


def imported(folder: Path, out: Path, declared: Declared | None = None):
    """Return the dataset, what was left out, and the messages of the first recording."""
    importer = ColumnMapImporter(read_column_map(folder / "map.toml"), declared)
    problems: list[str] = []
    dataset = import_dataset(
        importer, importer.reaches(ImportFiles([folder])), out, load_objects("ycb"),
        ImportOptions(), ["ycb"], problems,
    )  # fmt: skip
    return dataset, problems, list(open_source(dataset.recording(dataset.trials[0])))


def course(messages):
    """Return times and positions of the right hand where it was seen."""
    seen = [(m.t, m.hands["right"].position) for m in messages if m.hands["right"] is not None]
    return np.array([t for t, _ in seen]), np.array([p for _, p in seen])


def assert_is_the_reach(messages, table, lost=0, tolerance=2e-3):
    times, points = course(messages)
    assert len(messages) - len(times) == pytest.approx(lost, abs=2 if lost else 0)
    for axis in range(3):
        expected = np.interp(times, table[:, 0] - table[0, 0], table[:, 1 + axis] / 1000.0)
        assert np.abs(points[:, axis] - expected).max() < tolerance


def remarks(dataset):
    found = dataset.description["derived"].get("remarks", {}).values()
    return " | ".join(remark for remarks in found for remark in remarks)


# the shared instances -----------------------------------------------------------------------------

READ = ["dialect/latin1", "dialect/semicolon", "dialect/tab_in_csv", "dialect/tsv_comma",
        "dialect/upper", "dialect/utf16", "headers/footer", "headers/motive", "headers/qtm",
        "headers/trc", "headers/trc_tsv", "times/dupt", "times/hms", "times/iso", "times/jump20",
        "times/reset", "times/stepback", "names/NA"]  # fmt: skip


def shared(name: str) -> Path:
    if not (SHARED / name).is_dir():
        pytest.skip("the shared inputs are not beside the checkout")
    return SHARED / name


@pytest.mark.parametrize("name", READ)
def test_shared_tables_are_read(tmp_path, name):
    reference = imported(shared("names/Near").parent / "NA", tmp_path / "reference")[2]
    _, problems, messages = imported(shared(name), tmp_path / "out")
    assert problems == []
    times, points = course(messages)
    expected_times, expected = course(reference)
    assert len(times) == len(expected_times)
    assert np.abs(times - expected_times).max() < 1e-6
    assert np.abs(points - expected).max() < 6e-3  # one sample of a reach, where a time was wrong


REFUSED = [("units/mm_as_m", "in mm"), ("times/ms_as_s", "steps of 10 s: are these ms"),
           ("names/Near", "'Near' has no position; did you mean 'near'")]  # fmt: skip


@pytest.mark.parametrize(("name", "words"), REFUSED)
def test_shared_tables_that_cannot_be_meant_so_are_refused(tmp_path, name, words):
    with pytest.raises(DatasetError, match=words.replace("?", r"\?")):
        imported(shared(name), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["zero-is-lost/m9999", "zero-is-lost/zeros"])
def test_shared_numbers_for_not_there_are_gaps(tmp_path, name):
    dataset, _, messages = imported(shared(name), tmp_path / "out")
    lost = [m.t for m in messages if m.hands["right"] is None]
    assert min(lost) > 0.9
    assert max(lost) < 1.1
    assert len(lost) == 5
    assert "20 samples" in remarks(dataset)


def test_a_shared_world_with_y_up(tmp_path):
    dataset, _, _ = imported(shared("frames/yup"), tmp_path / "as_it_is")
    assert 'declare up = "y"' in remarks(dataset)
    dataset, _, messages = imported(shared("frames/yup"), tmp_path / "out", Declared(up="y"))
    reference = imported(shared("names/NA"), tmp_path / "reference")[2]
    assert np.abs(course(messages)[1] - course(reference)[1]).max() < 1e-9
    near = messages[0].objects["near"].position
    assert near == pytest.approx(reference[0].objects["near"].position, abs=1e-9)
    assert dataset.description["derived"]["converted_from"][0]["axes"] == ["x", "-z", "y"]


def test_shared_texts_stay_texts(tmp_path):
    dataset, _, _ = imported(shared("names/NA"), tmp_path / "out")
    assert [trial.participant for trial in dataset.trials] == ["NA", "None"]


# further instances --------------------------------------------------------------------------------

TABLE = plain.samples()
DIALECTS = {
    "tabs and decimal points": {"separator": "\t"},
    "bars": {"separator": "|"},
    "blanks": {"separator": "  "},
    "quoted commas": {"separator": '","', "decimal": ","},
}


@pytest.mark.parametrize("name", DIALECTS)
@pytest.mark.parametrize("ending", ["csv", "TXT", "tsv"])
def test_dialects(tmp_path, name, ending):
    rows = plain.lines(TABLE, **DIALECTS[name])
    if name == "quoted commas":
        rows = [f'"{row}"' for row in rows]
    folder = plain.write(tmp_path / "in", rows, f"take1.{ending}")
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize(
    "encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp1252", "latin-1"]
)
def test_encodings(tmp_path, encoding):
    trials = "take1,Zoë Müller,right,near\n"
    folder = plain.write(tmp_path / "in", plain.lines(TABLE), encoding=encoding, trials=trials)
    dataset, _, messages = imported(folder, tmp_path / "out")
    assert dataset.trials[0].participant == "Zoë Müller"
    assert_is_the_reach(messages, TABLE)


@pytest.mark.parametrize("end", ["\r\n", "\r"])
def test_line_ends(tmp_path, end):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE))
    text = (folder / "take1.csv").read_text().replace("\n", end)
    (folder / "take1.csv").write_bytes(text.encode())
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


def test_compressed_and_in_folders(tmp_path):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE))
    (folder / "P01" / "day 1").mkdir(parents=True)
    data = (folder / "take1.csv").read_bytes()
    (folder / "take1.csv").unlink()
    (folder / "P01" / "day 1" / "take1.csv.gz").write_bytes(gzip.compress(data))
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize("word", ["NA", "None", "n/a", "NaN", "", "null", "-", "#N/A", "1.#QNAN"])
def test_words_for_missing_numbers(tmp_path, word):
    table = TABLE.copy()
    table[120:140, 1:] = np.nan
    folder = plain.write(tmp_path / "in", plain.lines(table, empty=word))
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE, lost=6, tolerance=0.02)


@pytest.mark.parametrize("value", ["-9999", "9999.0", "-999999", "1e38", "77777"])
def test_numbers_for_not_there(tmp_path, value):
    table = TABLE.copy()
    table[120:140, 1:] = np.nan
    more = f'missing = ["{value}", "gone"]' if value == "77777" else ""
    folder = plain.write(tmp_path / "in", plain.lines(table, empty=value), more=more)
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE, lost=6, tolerance=0.02)


def test_a_hand_that_rests_at_the_origin_is_seen(tmp_path):
    table = TABLE.copy()
    table[:, 1:] -= table[0, 1:]
    table[:50, 1:] = 0.0
    table[50:, 1:] -= table[50, 1:]
    folder = plain.write(tmp_path / "in", plain.lines(table))
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], table)


def test_frame_numbers_and_a_rate(tmp_path):
    table = TABLE.copy()
    table[:, 0] = np.arange(len(table)) + 17
    folder = plain.write(
        tmp_path / "in", plain.lines(table, header="Frame,x,y,z"), more="rate = 100.0"
    )
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)
    (folder / "map.toml").write_text((folder / "map.toml").read_text().replace("rate", "# rate"))
    with pytest.raises(DatasetError, match="no column of times and no rate; declare rate"):
        imported(folder, tmp_path / "again")


def test_several_rows_of_names(tmp_path):
    rows = [",palm,,", "time,X,Y,Z", "s,mm,mm,mm", *plain.lines(TABLE, header="")]
    folder = plain.write(tmp_path / "in", rows, unit="")
    text = (folder / "map.toml").read_text()
    columns = '[samples]\nt = "time"\nx = "palm/X"\ny = "palm/Y"\nz = "palm/Z"\n'
    (folder / "map.toml").write_text('unit = "mm"\n' + text.replace("[samples]\n", columns))
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


def test_no_header(tmp_path):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE, header=""))
    columns = "".join(f'{n} = "column {k}"\n' for k, n in enumerate("txyz", 1))
    text = (folder / "map.toml").read_text().replace("[samples]\n", f"[samples]\n{columns}")
    (folder / "map.toml").write_text(text)
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize("footer", [["", "Mean,0,0,0"], ["# end"], ["", "", "211 rows"], [";;;"]])
def test_footers(tmp_path, footer):
    folder = plain.write(tmp_path / "in", [*plain.lines(TABLE), *footer])
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize(
    ("form", "offset"),
    [("{h:02d}:{m:02d}:{s:07.4f}", 86399.0), ("2024-02-28T{h:02d}:{m:02d}:{s:07.4f}", 3600.0),
     ("2024-02-28 {h:02d}:{m:02d}:{s:07.4f}+01:00", 0.0)],
)  # fmt: skip
def test_times_of_day_and_dates(tmp_path, form, offset):
    rows = ["t,x,y,z"]
    for row in TABLE:
        t = (row[0] + offset) % 86400.0
        text = form.format(h=int(t // 3600), m=int(t % 3600 // 60), s=t % 60.0)
        rows.append(",".join([text, *(f"{v:.4f}" for v in row[1:])]))
    folder = plain.write(tmp_path / "in", rows)
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize("step", [-0.02, -0.4, -5.0, -1e4, 3.0, 900.0])
def test_a_clock_that_steps(tmp_path, step):
    table = TABLE.copy()
    table[100:, 0] += step
    folder = plain.write(tmp_path / "in", plain.lines(table))
    dataset, _, messages = imported(folder, tmp_path / "out")
    assert_is_the_reach(messages, TABLE, tolerance=0.02)
    assert "in line 102" in remarks(dataset)


def test_a_pause_is_a_gap(tmp_path):
    table = np.delete(TABLE, slice(5, 45), axis=0)
    table[5:, 0] += 4.0
    folder = plain.write(tmp_path / "in", plain.lines(table))
    dataset, _, messages = imported(folder, tmp_path / "out")
    assert "nothing was recorded" in remarks(dataset)
    assert messages[60].hands["right"] is None


def test_rows_in_no_order(tmp_path):
    order = np.random.default_rng(3).permutation(len(TABLE))
    folder = plain.write(tmp_path / "in", plain.lines(TABLE[order]))
    dataset, _, messages = imported(folder, tmp_path / "out")
    assert_is_the_reach(messages, TABLE)
    assert "not in order" in remarks(dataset)


@pytest.mark.parametrize(
    ("factor", "unit", "words"),
    [(1.0, "m", "in mm"), (0.001, "mm", "in m"), (0.1, "mm", "scene"), (1.0, "cm", None)],
)
def test_units_of_length(tmp_path, factor, unit, words):
    table = TABLE.copy()
    table[:, 1:] *= factor
    folder = plain.write(tmp_path / "in", plain.lines(table), unit=f'unit = "{unit}"')
    if factor != 1.0:
        text = (folder / "map.toml").read_text()
        for number in ("-100.0", "400.0", "90.0", "300.0", "50.0"):
            text = text.replace(f"= {number}", f"= {float(number) * factor}")
        (folder / "map.toml").write_text(text)
    if words in (None, "scene"):  # ten times too large or small can be meant
        imported(folder, tmp_path / "out")
        return
    with pytest.raises(DatasetError, match=words):
        imported(folder, tmp_path / "out")


@pytest.mark.parametrize(("factor", "fits"), [(1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_units_of_time(tmp_path, factor, fits):
    table = TABLE.copy()
    table[:, 0] *= factor
    folder = plain.write(tmp_path / "in", plain.lines(table))
    with pytest.raises(DatasetError, match=f"are these {fits}"):
        imported(folder, tmp_path / "out")
    folder = plain.write(tmp_path / "in", plain.lines(table), more=f'time_unit = "{fits}"')
    assert_is_the_reach(imported(folder, tmp_path / "out")[2], TABLE)


@pytest.mark.parametrize(
    ("declared", "world"),
    [
        (Declared(up="y"), [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        (Declared(up="x"), [[0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        (Declared(axes=("x", "-z", "y")), [[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
        (Declared(axes="-y,x,z"), [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    ],
)
def test_declared_frames(tmp_path, declared, world):
    world = np.array(world, dtype=float)  # the file's from ours
    table = TABLE.copy()
    table[:, 1:] = TABLE[:, 1:] @ world.T
    folder = plain.write(tmp_path / "in", plain.lines(table))
    messages = imported(folder, tmp_path / "out", declared)[2]
    assert_is_the_reach(messages, TABLE)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("take1,P01,right,Near", "did you mean 'near'"),
        ("take1,P01,right,nearr", "did you mean 'near'"),
        ("take01,P01,right,near", "no samples; did you mean 'take1'"),
        ("take1,P01,,near", "its hand is not known"),
        ("take1,P01,right,n/a", "'target' is empty"),
    ],
)
def test_near_misses_are_named(tmp_path, row, words):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE), trials=row + "\n")
    with pytest.raises(DatasetError, match=words):
        imported(folder, tmp_path / "out")


@pytest.mark.parametrize("hand", ["Right", "R", "right_hand", "RIGHT", "rh", "Right hand"])
def test_hands_in_other_spellings(tmp_path, hand):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE), trials=f"take1,P01,{hand},near\n")
    dataset, _, messages = imported(folder, tmp_path / "out")
    assert dataset.trials[0].hand == "right"
    assert_is_the_reach(messages, TABLE)


@pytest.mark.parametrize(
    ("person", "name"),
    [("NA", "NA"), ("None", "None"), ("null", "null"), ("007", "007"), ("1.0", "1.0"),
     ("", "unknown"), ("n/a", "unknown"), (" N/A ", "unknown")],
)  # fmt: skip
def test_texts_stay_texts(tmp_path, person, name):
    folder = plain.write(tmp_path / "in", plain.lines(TABLE), trials=f"take1,{person},right,near\n")
    assert imported(folder, tmp_path / "out")[0].trials[0].participant == name
