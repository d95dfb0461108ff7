"""How every command behaves where something is wrong: one line, and the right exit code."""

from __future__ import annotations

import importlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from datasets import MESH
from igrip import Observation
from igrip.cli import console, outputs
from igrip.cli.app import COMMANDS, app, target_of
from igrip.errors import did_you_mean
from igrip.experiment.folder import new_study
from igrip.io.datasets.dataset import Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.io.recordings.jsonl import JsonlWriter
from igrip.lab import parallel
from igrip.objects.catalog import Catalog

WAIT = 240  # s; a busy machine is slow

# of each command, arguments that are right but for what a test changes
ARGUMENTS = {
    "bench": ["--frames", "20", "--runs", "1"],
    "benchmark": ["small=small", "--out", "judged", "--entry", "distance"],
    "calibrate": ["--camera", "rendered", "--out", "cameras.json"],
    "certify": ["--device", "serial", "--config", "device.toml"],
    "check": ["small"],
    "demo": ["--headless", "--speed", "0", "--duration", "1"],
    "doctor": [],
    "drive": ["--device", "serial", "--config", "device.toml", "--headless"],
    "evaluate": ["small", "--out", "report", "--targets", "distance"],
    "experiment": [
        "run",
        "study",
        "--participant",
        "P01",
        "--consent",
        "2026-01-31",
        "--simulate",
        "--unattended",
    ],
    "export": ["small", "--out", "exported"],
    "grips": [],
    "import": ["table.csv", "--out", "imported"],
    "list": [],
    "live": ["--camera", "rendered", "--hands", "none", "--poses", "none", "--headless"],
    "record": ["--out", "frames.mcap", "--camera", "rendered"],
    "replay": ["small/recordings/reach0.jsonl", "--objects", MESH, "--targets", "distance"],
    "scan": ["cup", "--camera", "rendered"],
    "schema": ["observation"],
    "simulate": ["cohort", "--participants", "1", "--trials", "1", "--no-reach", "0"],
    "stream": ["--in", "stdin", "--out", "stdout"],
    "view": ["small", "--targets", "distance"],
}


@pytest.fixture
def folder(tmp_path, monkeypatch, small_dataset):
    """A working folder with a dataset ``small``, a table, a file and a folder."""
    (tmp_path / "table.csv").write_text("a,b\n1,2\n")
    (tmp_path / "file").write_text("kept")
    (tmp_path / "device.toml").write_text('port = "twin"\n')
    new_study(tmp_path / "study", "small")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console.errors, "_width", 300)
    return tmp_path


@pytest.fixture
def nothing_slow(monkeypatch):
    """Fail if models of objects are read."""
    monkeypatch.setattr(Catalog, "__init__", lambda *_: pytest.fail("began to read models"))


def run(*arguments):
    """Run a command in this process; return exit code, output and the lines on standard error."""
    done = CliRunner().invoke(app, [str(a) for a in arguments])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.exit_code, done.stdout, done.stderr.splitlines()


def refusal(*arguments):
    """Return the one line of a command that is refused."""
    code, output, lines = run(*arguments)
    assert code == 2, (output, lines)
    assert output == ""
    assert len(lines) == 1, lines
    assert lines[0].startswith("igrip: ")
    return lines[0]


def test_the_table_names_every_command():
    assert set(COMMANDS) <= {*ARGUMENTS, "tune"}


# outputs that cannot be written -------------------------------------------------------------------

FILES = [
    ("calibrate", "--out", ".json"), ("calibrate", "--lens", ".json"),
    ("calibrate", "--board", ".svg"),
    ("grips", "--out", ".png"), ("import", "--write-map", ".toml"),
    ("live", "--person", ".json"), ("record", "--out", ".mcap"), ("replay", "--plot", ".pdf"),
    ("replay", "--out", ".csv"), ("replay", "--out", ".jsonl"), ("replay", "--out", ".parquet"),
    ("stream", "--person", ".json"),
]  # fmt: skip
FOLDERS = [
    ("benchmark", "--out"), ("certify", "--out"), ("evaluate", "--out"), ("import", "--out"),
    ("scan", "--out"), ("simulate", None),
]  # fmt: skip


def with_option(command, option, value):
    """Return the arguments of a command with another value of an option, or of its argument."""
    usual = ARGUMENTS[command]
    if option is None:
        return [command, value, *usual[1:]]
    if option in usual:
        place = usual.index(option)
        usual = usual[:place] + usual[place + 2 :]
    return [command, *usual, option, value]


@pytest.mark.parametrize(("command", "option", "ending"), FILES)
@pytest.mark.parametrize(
    ("place", "words"),
    [("gone/new", "there is no folder gone"), ("file/new", "file is not a folder"),
     ("here", "is a folder; name a file")],
)  # fmt: skip
def test_a_file_that_cannot_be_written(folder, nothing_slow, command, option, ending, place, words):
    name = f"{place}{ending}"
    if place == "here":
        (folder / name).mkdir()
    line = refusal(*with_option(command, option, name))
    assert name in line
    assert words in line


@pytest.mark.parametrize(("command", "option"), FOLDERS)
def test_a_folder_that_cannot_be_written(folder, nothing_slow, command, option):
    assert "file/new: cannot be written" in refusal(*with_option(command, option, "file/new"))
    line = refusal(*with_option(command, option, "file"))
    assert "file: is a file" in line or "file: exists already" in line
    assert (folder / "file").read_text() == "kept"


def test_what_permissions_forbid(folder, monkeypatch):
    def forbidden(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(outputs.tempfile, "TemporaryFile", forbidden)
    for command, option, ending in FILES:
        if option != "--out" and "--out" in ARGUMENTS[command]:  # --out is tried first
            continue
        line = refusal(*with_option(command, option, f"new{ending}"))
        assert f"new{ending}: cannot be written: Permission denied" in line


def test_trying_an_output_leaves_nothing_and_changes_nothing(folder):
    before = sorted(folder.iterdir())
    assert outputs.check_file(Path("new.csv")) == Path("new.csv")
    outputs.check_folder(Path("new/deeper"))
    outputs.check_file(Path("file"))
    assert sorted(folder.iterdir()) == before
    assert (folder / "file").read_text() == "kept"


@pytest.mark.parametrize("option", ["--out", "--plot"])
def test_other_endings_are_refused_with_the_list(folder, nothing_slow, option):
    listed = {"--out": ".jsonl, .mcap, .csv or .parquet", "--plot": ".png, .svg or .pdf"}
    assert f"x.xls: the ending must be {listed[option]}" in refusal(
        "replay", *ARGUMENTS["replay"], option, "x.xls"
    )


def test_an_output_that_is_missing(nothing_slow):
    for command in ("evaluate", "record"):
        line = refusal(command, *(["small"] if command == "evaluate" else []))
        assert "Missing option '--out'" in line
        assert f"see: igrip {command} --help" in line


def test_a_disk_that_is_full(folder, monkeypatch):
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with open("/dev/full", "w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        with pytest.raises(SystemExit) as ended:
            app(["list", "targets"])
        monkeypatch.undo()
    console.output._buffer.clear()
    assert ended.value.code == 2


# names --------------------------------------------------------------------------------------------

TYPOS = [
    (["benchmark", "small=small", "--entry", "bayse"], "bayes"),
    (["certify", "--device", "rehastm2", "--config", "device.toml"], "rehastim2"),
    (["demo", "--targets", "bayse"], "bayes"),
    (["demo", "--headless", "--fault", "frezze@1+1"], "freeze"),
    (["experiment", "new", "mine", "--template", "papr"], "paper"),
    (["drive", "--device", "serail", "--config", "device.toml"], "serial"),
    (["evaluate", "small", "--out", "r", "--targets", "papre"], "paper"),
    (["evaluate", "small", "--out", "r", "--grips", "contcat"], "contact"),
    (["evaluat"], "evaluate"),
    (["list", "camera"], "cameras"),
    (["live", "--headless", "--camera", "rendred"], "rendered"),
    (["live", "--headless", "--camera", "rendered", "--hands", "mediapip"], "mediapipe"),
    (["live", "--headless", "--camera", "rendered", "--poses", "dept"], "depth"),
    (["live", "--headless", "--camera", "rendered", "--out", "stdotu"], "stdout"),
    (["record", "--out", "x.mcap", "--camera", "webcm:0"], "webcam"),
    (["replay", "small", "--targets", "repared"], "repaired"),
    (["replay", "small", "--target", "paper"], "--targets"),
    (["schema", "observatoin"], "observation"),
    (["simulate", "new", "--profile", "strok"], "stroke"),
    (["stream", "--in", "stdni"], "stdin"),
    (["stream", "--out", "lls"], "lsl"),
    (["view", "small", "--targets", "distanze"], "distance"),
]


@pytest.mark.parametrize(("arguments", "meant"), TYPOS, ids=lambda a: " ".join(a)[:40])
def test_a_typo_is_answered_with_the_name_that_was_meant(folder, nothing_slow, arguments, meant):
    assert f"'{meant}'" in refusal(*arguments).replace(meant, f"'{meant}'")


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [(["grips", "006_mustard_botle"], "006_mustard_bottle"), (["grips", "bleach"], "021_bleach"),
     (["import", "table.csv", "--out", "d", "--mesh", "soup"], "005_tomato_soup_can"),
     (["stream", "--in", "stdin", "--preload", "003_craker_box"], "003_cracker_box"),
     (["live", *ARGUMENTS["live"], "--model", "003_craker_box"], "003_cracker_box")],
    ids=lambda a: " ".join(a)[:40],
)  # fmt: skip
def test_a_model_that_does_not_exist_is_answered_with_the_nearest(folder, arguments, meant):
    code, _, lines = run(*arguments)
    assert code == 2
    assert re.search(rf"no model .* \(did you mean '{meant}", lines[-1])


def test_a_part_of_one_name_alone_is_near_to_it():
    names = ["002_master_chef_can", "006_mustard_bottle", "007_tuna_fish_can"]
    assert did_you_mean("mustard", names) == " (did you mean '006_mustard_bottle'?)"
    assert did_you_mean("can", names) == ""
    assert did_you_mean("zz", names) == ""


@pytest.mark.parametrize(
    ("text", "meant"), [("[mug]\nunti = 'mm'\n", "unit"), ("[mug]\naxes = [0, 0, 1]\n", "axis")]
)
def test_a_typo_in_objects_toml(folder, text, meant):
    import trimesh

    (folder / "meshes").mkdir()
    trimesh.creation.box((0.07, 0.07, 0.1)).export(folder / "meshes" / "mug.stl")
    (folder / "meshes" / "objects.toml").write_text(text)
    line = refusal("list", "models", "--objects", "meshes")
    assert "objects.toml: [mug]" in line
    assert f"did you mean '{meant}'?" in line
    assert "symmetry" in line  # all that there are


def test_a_typo_in_a_map_of_columns_and_in_an_option_of_poses(folder):
    (folder / "map.toml").write_text("[samples]\nframme = 'n'\n")
    line = refusal("import", "table.csv", "--out", "d", "--columns", "map.toml")
    assert "map.toml: samples: there is no 'framme' (did you mean 'frame'?)" in line
    arguments = ["live", "--camera", "rendered", "--hands", "none", "--headless"]
    _, _, lines = run(*arguments, "--option", "max_misfitt=1")
    assert "depth: there is no 'max_misfitt' (did you mean 'max_misfit'?)" in lines[-1]


def test_help_lists_the_names():
    for command in ("demo", "evaluate", "replay", "stream", "view", "live"):
        code, output, _ = run(command, "--help")
        assert code == 0
        assert {"distance_derivative", "repaired"} <= set(re.findall(r"\w+", output)), command


def test_list_names_every_family(folder):
    code, output, _ = run("list", "--json")
    names = json.loads(output)
    assert code == 0
    assert {"targets", "cues", "grips", "cameras", "hands", "poses", "inputs", "outputs", "models",
            "importers", "layouts"} <= set(names)  # fmt: skip
    assert len(names["models"]) == 78
    for family in names:
        assert run("list", family)[1].split() == names[family]
        assert family in run("list")[1]


def test_replay_warns_of_a_model_that_does_not_exist(folder):
    pose = {"model": "006_mustrd_bottle", "position": [0, 0.4, 0], "orientation": [0, 0, 0, 1]}
    with DatasetWriter(folder / "set", "set", "MIT", "made by hand", objects=["ycb"]) as writer:
        messages = [
            Observation(t=k / 30, hands={"right": {"position": [0, 0.01 * k, 0]}},
                        objects={"mustard": pose})
            for k in range(20)
        ]  # fmt: skip
        writer.add(Trial("one", "p1", "1", hand="right", target="mustard", onset_s=0.1, end_s=0.5),
                   messages)  # fmt: skip
        writer.close()
    words = "mustard: the catalogue has no model '006_mustrd_bottle' (did you mean"
    for recording in ("set/recordings/one.jsonl", "set"):
        _, output, lines = run("replay", recording, "--targets", "distance", "--json")
        assert json.loads(output)
        assert any(words in line for line in lines), lines
    assert words in run("replay", "set", "--targets", "distance")[1]


# Ctrl-C -------------------------------------------------------------------------------------------


def interrupt(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize("command", sorted({*COMMANDS} & {*ARGUMENTS} - {"list", "schema"}))
def test_ctrl_c_before_anything_was_done(folder, monkeypatch, command):
    module = importlib.import_module(target_of(command)[0])
    first = {
        "calibrate": "open_camera", "record": "open_camera", "scan": "open_camera",
        "drive": "open_source", "export": "progress",
    }.get(command, "load_objects")  # fmt: skip
    opener = module
    if not hasattr(module, first):  # the evaluation and a study load them themselves
        opener = importlib.import_module(
            "igrip.experiment.folder"
            if command == "experiment"
            else "igrip.lab.evaluation.evaluation"
        )
    monkeypatch.setattr(opener, first, interrupt)
    with restored_interrupts():
        code, output, lines = run(command, *ARGUMENTS[command])
    assert code == 130
    assert output == ""
    assert lines[-1].startswith("igrip: stopped; ")
    assert "Traceback" not in "".join(lines)


@contextmanager
def restored_interrupts():
    before = signal.getsignal(signal.SIGINT)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    ("arguments", "place", "words"),
    [
        (["replay", "small", "--targets", "distance", "--out", "i.csv"],
         "igrip.cli.replay.summarise_replay", "nothing was written"),
        (["replay", *ARGUMENTS["replay"], "--out", "i.csv"],
         "igrip.lab.evaluation.runner.EstimatorRun.update",
         "the intentions until now are in i.csv; run again"),
        (["evaluate", *ARGUMENTS["evaluate"], "--jobs", "1"],
         "igrip.lab.evaluation.runner.EstimatorRun.update",
         "what is done is kept in report; the same command goes on from there"),
        (["simulate", *ARGUMENTS["simulate"]], "igrip.lab.simulation.cohort.perform",
         "what is done is kept; the same command goes on from there"),
        (["check", "small"], "igrip.cli.check.check_trial", "nothing was written"),
    ],
    ids=lambda a: a[0] if isinstance(a, list) else None,
)  # fmt: skip
def test_ctrl_c_in_the_middle_names_what_is_kept(folder, monkeypatch, arguments, place, words):
    monkeypatch.setattr(place, interrupt)
    with restored_interrupts():
        code, output, lines = run(*arguments)
    assert code == 130
    assert output == ""
    assert len(lines) == 1
    assert words in lines[0]
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_the_signal_itself_ends_a_command_in_one_line(tmp_path):
    """Also the processes of the command get it, as from a terminal."""
    command = [sys.executable, "-m", "igrip", "simulate", "cohort"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, start_new_session=True) as process:  # fmt: skip
        try:
            deadline = time.monotonic() + WAIT
            while not list(tmp_path.glob(".cohort-*/recordings/*")) and process.poll() is None:
                assert time.monotonic() < deadline
                time.sleep(0.05)
            os.killpg(process.pid, signal.SIGINT)
            output, errors = process.communicate(timeout=WAIT)
        finally:
            process.kill()
    assert process.returncode == 130
    assert output == ""
    lines = errors.splitlines()
    assert lines == ["igrip: stopped; what is done is kept; the same command goes on from there"]
    assert [path.name for path in tmp_path.iterdir()] == [".cohort-unfinished"]


def test_other_processes_leave_ctrl_c_to_the_first():
    before = signal.getsignal(signal.SIGINT)
    with parallel._interrupts_ignored():
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert signal.getsignal(signal.SIGINT) is before


# readers that go ----------------------------------------------------------------------------------

PRINTING = [
    ["--help"], ["check", "small"], ["demo", *ARGUMENTS["demo"]], ["doctor", "--json"], ["grips"],
    ["list"], ["list", "models"], ["list", "--json"], ["replay", *ARGUMENTS["replay"]],
    ["replay", "small", "--targets", "distance"], ["replay", "--help"], ["schema", "intention"],
    ["simulate", *ARGUMENTS["simulate"]],
]  # fmt: skip


@pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)
def test_a_reader_that_has_gone_ends_a_command_quietly(folder, monkeypatch, capsys, arguments):
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "w") as pipe:
        monkeypatch.setattr(sys, "stdout", pipe)
        with pytest.raises(SystemExit) as ended:
            app(arguments)
        monkeypatch.setattr(sys, "stdout", sys.__stdout__)
    assert ended.value.code == 0
    errors = capsys.readouterr().err
    assert "Traceback" not in errors
    assert "roken" not in errors


def test_head_of_a_process():
    command = [sys.executable, "-m", "igrip", "list", "models"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        errors = process.stderr.read()
        assert process.wait(timeout=WAIT) == 0
    assert errors == b""


@pytest.mark.parametrize(("arguments", "code"), [(["list", "models"], 0), (["replay", "no"], 2)])
def test_head_of_both_streams_of_a_process(arguments, code):
    command = [sys.executable, "-m", "igrip", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        process.stdout.close()
        assert process.wait(timeout=WAIT) == code


# ports --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["view", *ARGUMENTS["view"]], "--port"),
        (["demo", "--duration", "1"], "--port"),
        (["grips", "--page"], "--port"),
        (["live", "--camera", "rendered", "--hands", "none", "--poses", "none"], "--page-port"),
        (["live", *ARGUMENTS["live"], "--out", "ws"], "--port"),
        (["stream"], "--port"),
        (["stream", "--in", "stdin", "--out", "ws"], "--port"),
        (["stream", "--in", "osc", "--out", "stdout"], "--osc-port"),
    ],
    ids=lambda a: " ".join(a)[:30] if isinstance(a, list) else a,
)
def test_a_busy_port_is_refused_alike(folder, nothing_slow, arguments, option):
    kind = socket.SOCK_DGRAM if option == "--osc-port" else socket.SOCK_STREAM
    with closing(socket.socket(socket.AF_INET, kind)) as busy:
        busy.bind(("127.0.0.1", 0))
        if kind == socket.SOCK_STREAM:
            busy.listen()
        port = busy.getsockname()[1]
        line = refusal(*arguments, option, port)
    assert line == (
        f"igrip: port {port} is in use, perhaps by another igrip: name another with {option}, "
        f"or {option} 0 for any that is free"
    )


def test_any_free_port_and_a_host_of_another_machine():
    assert outputs.free_port(0) > 0
    with pytest.raises(outputs.OutputError, match=r"cannot listen on 192\.0\.2\.1:"):
        outputs.free_port(0, host="192.0.2.1")  # reserved for documentation (RFC 5737)


# log lines ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("verbose", [False, True])
def test_the_lines_of_other_libraries_do_not_bury_ours(tmp_path, verbose):
    code = (
        "import logging, os, sys, warnings; from igrip.cli.log_lines import keep_apart; "
        "keep_apart(); os.write(2, b'I0000 from C\\n'); logging.getLogger('other').warning('log'); "
        "warnings.warn('old'); print('ours', file=sys.stderr)"
    )
    environment = {k: v for k, v in os.environ.items() if k != "IGRIP_VERBOSE"}
    environment |= {"IGRIP_VERBOSE": "1"} if verbose else {}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          timeout=WAIT, env=environment)  # fmt: skip
    assert done.returncode == 0
    if verbose:
        assert {"I0000 from C", "log", "ours"} <= set(done.stderr.splitlines())
    else:
        assert done.stderr == "ours\n"


def test_a_recording_of_igrip_writes_nothing_but_its_lines(folder):
    with JsonlWriter("cut.jsonl") as writer:
        writer.write(Observation(t=0.0, hands={"right": {"position": [0, 0, 0]}}))
    _, _, lines = run("replay", "cut.jsonl", "--objects", MESH, "--targets", "distance")
    assert lines == ["no object was seen: there is no target to choose"]
