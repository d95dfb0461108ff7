"""Every table that igrip prints, in narrow and wide terminals."""

from __future__ import annotations

import io
import re

import pytest
from rich.cells import cell_len
from rich.console import Console
from typer.testing import CliRunner

from datasets import MESH
from igrip import Intention
from igrip.cli import bench, console, demo, live_table
from igrip.cli.app import app
from igrip.cli.console import table_of
from igrip.lab.simulation.demo import DemoPerson
from igrip.lab.simulation.demo_score import DemoScore

WIDE = 1000  # nothing folds
NUMBER = re.compile(r"-?\d+(?:[.,]\d+)*")
TIMES = {"p50_ms": 0.277, "p99_ms": 0.868, "rays": 720.0, "ray_nodes": 12345.0,
         "point_nodes": 2345.0}  # fmt: skip
BENCH = {
    "machine": {"platform": "Linux", "python": "3.12", "processors": 2, "load_average": None},
    "peers": {
        "best": {"igrip, update with bayes, every ray, both distances": TIMES, "embreex": TIMES},
        "plain_trimesh": None, "ratios": {}, "ratios_of_runs": {}, "missing": [],
    },
    "cadence_30_hz": TIMES,
    "growth": {"objects": [{"case": 4} | TIMES, {"case": 100} | TIMES]},
}  # fmt: skip
STAGE = {"rate": 29.7, "age_p50_ms": 81.0, "duration_p50_ms": 14.0, "skipped": 12345, "failed": 7}
REACHING = Intention(
    t=1.0, hand="right", status="reaching", target="021_bleach_cleanser", confidence=0.83,
    grip="palmar", time_to_contact=0.41, probability={"021_bleach_cleanser": 0.83, "none": 0.17},
)  # fmt: skip


def command(*arguments):
    def print_it():
        done = CliRunner().invoke(app, [str(a) for a in arguments])
        assert done.exit_code == 0, done.output
        return done.stdout

    return print_it


def rendered(*things):
    """Return what a console of the present width prints."""
    file = io.StringIO()
    shown = Console(file=file, width=console.output.width)
    for thing in things:
        shown.print(thing)
    return file.getvalue()


def bench_report(monkeypatch):
    with monkeypatch.context() as patch, console.output.capture() as captured:
        patch.setattr(bench, "warn", print)
        bench.print_report(BENCH)
    return captured.get()


def demo_table(ycb):
    moment = next(iter(DemoPerson(ycb, 0)))
    return demo._table(moment, [REACHING], DemoScore())


def map_with_long_names(folder):
    rows = ["t,wrist_marker_of_the_right_hand_X,wrist_marker_of_the_right_hand_Y,"
            "wrist_marker_of_the_right_hand_Z"]  # fmt: skip
    rows += [f"{k / 100},{0.1234 + k / 1000},{0.5},{0.25}" for k in range(50)]
    (folder / "take.csv").write_text("\n".join(rows) + "\n")
    return folder / "take.csv"


@pytest.fixture
def printers(small_dataset, ycb, tmp_path, monkeypatch):
    """Return what prints each table, by name."""
    monkeypatch.setattr("igrip.lab.report.page.write_report", lambda *_: None)
    recording = small_dataset.recording(small_dataset.trials[0])
    replay = ("--targets", "distance", "--objects", MESH)
    return {
        "list": command("list"),
        "doctor": command("doctor"),
        "replay of a recording": command("replay", recording, *replay),
        "replay of a dataset": command("replay", small_dataset.path, *replay),
        "evaluate": command("evaluate", small_dataset.path, "--out", tmp_path / "r", *replay),
        "import --inspect": command("import", "--inspect", map_with_long_names(tmp_path)),
        "bench": lambda: bench_report(monkeypatch),
        "live": lambda: rendered(live_table.live_table(1.0, {"camera oak:14442C10": STAGE,
                                                              "hands": STAGE}, [REACHING])),
        "demo": lambda: rendered(demo_table(ycb)),
    }  # fmt: skip


NAMES = ["list", "doctor", "replay of a recording", "replay of a dataset", "evaluate",
         "import --inspect", "bench", "live", "demo"]  # fmt: skip


def table_lines(text):
    """Return the lines of tables alone: other lines are left to the terminal."""
    return [line for line in text.splitlines() if line[:1] in "┏┃┡│└├"]


def numbers_in(lines):
    return {found for line in lines for found in NUMBER.findall(line)}


@pytest.mark.parametrize("name", NAMES)
def test_no_number_is_cut_off_in_a_narrow_terminal(printers, name, monkeypatch):
    monkeypatch.setattr(console.output, "_width", WIDE)
    wide = printers[name]()
    for width in (60, 80, 120):
        monkeypatch.setattr(console.output, "_width", width)
        lines = table_lines(printers[name]()) if name != "doctor" else printers[name]().splitlines()
        assert lines
        assert max(map(cell_len, lines)) <= width
        if name not in ("doctor", "list"):  # there all is text, and may be wrapped
            whole = [line for line in table_lines(wide) if "recording" not in line]
            assert numbers_in(whole) <= numbers_in(lines), width
        assert "".join(lines).count("…") <= wide.count("…")  # no cell ends with one that was cut


@pytest.mark.parametrize("width", [60, 80, 120])
def test_columns_that_do_not_fit_stand_below_the_first_one_again(width):
    columns = ["targets", *(f"column {k}" for k in range(9))]
    rows = [[f"row {r}", *(f"{100 * r + k}.123" for k in range(9))] for r in range(3)]
    file = io.StringIO()
    Console(file=file, width=width).print(table_of(columns, rows, "title", "caption"))
    lines = file.getvalue().splitlines()
    assert lines[0] == "title"
    assert lines[-1] == "caption"
    assert max(map(cell_len, lines)) <= width
    parts = sum("targets" in line for line in lines)
    assert parts == -(-9 // ((width - 1 - 10) // 11))  # "targets" takes 10, each column 11
    assert all(sum(f"row {r}" in line for line in lines) == parts for r in range(3))
    for row in rows:
        for cell in row[1:]:
            assert sum(cell in re.split(r"[│\s]+", line) for line in lines) == 1


@pytest.mark.parametrize("width", [60, 80])
def test_both_columns_that_name_a_row_are_repeated_where_the_table_folds(width):
    columns = ["targets", "group", *(f"column {k}" for k in range(9))]
    rows = [["paper", group, *(f"{k}.5" for k in range(9))] for group in ("near", "far")]
    file = io.StringIO()
    Console(file=file, width=width).print(table_of(columns, rows, left=(1,), leading=2))
    cells = [line.split("│")[1:-1] for line in file.getvalue().splitlines() if "│" in line]
    parts = len(cells) // 2
    assert parts > 1
    assert [[cell.strip() for cell in line[:2]] for line in cells] == [
        ["paper", "near"], ["paper", "far"],
    ] * parts  # fmt: skip
    assert sorted(cell.strip() for line in cells for cell in line[2:]) == sorted(
        cell for row in rows for cell in row[2:]
    )


def test_long_text_is_wrapped_and_kept():
    name, text = "p01_t001_" + 60 * "x", "the recording holds no message of this hand " * 3
    file = io.StringIO()
    Console(file=file, width=60).print(
        table_of(("recording", "", "what"), [(name, "error", text)], left=(1, 2))
    )
    cells = [line.split("│")[1:-1] for line in file.getvalue().splitlines() if "│" in line]
    assert "".join(cell[0].strip() for cell in cells) == name
    assert " ".join(cell[2].strip() for cell in cells).split() == text.split()
