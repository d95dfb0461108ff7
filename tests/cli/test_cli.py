"""The commands as a user types them: in a process of their own."""

import json
import os
import re
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pandas as pd
import pytest
import trimesh

from datasets import MESH
from igrip import Observation
from igrip.cli.app import COMMANDS
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings.jsonl import JsonlWriter

SLOW_COMMAND = 240  # a cold kernel has to be compiled first [s]


def igrip(*arguments: object, code: int = 0) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-c", "from igrip.cli import main; main()", *map(str, arguments)],
        capture_output=True, text=True, timeout=SLOW_COMMAND,
        env={**os.environ, "COLUMNS": "160", "NO_COLOR": "1"},
    )  # fmt: skip
    assert done.returncode == code, done.stderr + done.stdout
    return done


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str) -> None:
    assert f"Example: igrip {command}" in igrip(command, "--help").stdout


def test_demo_headless() -> None:
    result = json.loads(igrip("demo", "--headless", "--speed", 0, "--json").stdout)
    assert result["reaches"] == 16
    assert result["targets_right"] >= 12


def test_demo_prints_each_reach_without_a_terminal() -> None:
    lines = igrip("demo", "--headless", "--speed", 0, "--duration", 8).stdout.splitlines()
    assert len(lines) == 3
    assert lines[-1].startswith("2 reaches: ")


def test_doctor() -> None:
    report = json.loads(igrip("doctor", "--json").stdout)
    assert report["ok"]
    assert all(report["core"].values())
    assert report["checks"]["objects"]["detail"].startswith("78 meshes")


def test_schemas_in_the_docs_are_those_of_the_code() -> None:
    folder = Path(__file__).parents[2] / "docs" / "schemas"
    for message in ("observation", "intention"):
        assert (folder / f"{message}.json").read_text() == igrip("schema", message).stdout


def test_replay_of_a_dataset(small_dataset: Dataset, tmp_path: Path) -> None:
    out = tmp_path / "intentions.jsonl"
    done = igrip(
        "replay", small_dataset.path, "--targets", "distance", "--targets", "paper", "--json",
        "--out", out,
    )  # fmt: skip
    summary = json.loads(done.stdout)
    rows = {(row["targets"], row["group"]): row for row in summary["results"]}
    assert rows["distance", "all"]["success"] == 1.0
    assert rows["distance", "near"]["trials"] == rows["distance", "far"]["trials"] == 1
    assert set(rows["paper", "all"]) >= {"accuracy_40%", "accuracy_60%", "delay_s", "margin_s"}
    intentions = [json.loads(line) for line in out.read_text().splitlines()]
    assert {line["hand"] for line in intentions} == {"right"}
    table = igrip("replay", small_dataset.path, "--targets", "distance").stdout
    assert "right at 40%" in table
    assert "100.0 %" in table


def test_replay_of_a_recording_that_was_cut(small_dataset: Dataset, tmp_path: Path) -> None:
    whole = small_dataset.recording(small_dataset.trials[0]).read_bytes()
    path = tmp_path / "cut.jsonl"
    path.write_bytes(whole[:-7])
    done = igrip("replay", path, "--objects", "cylinder:0.03x0.12", "--targets", "distance")
    assert "cut off in line 61; 60 messages read" in done.stderr
    assert "near" in done.stdout


def test_exit_codes(small_dataset: Dataset, tmp_path: Path) -> None:
    wrong = igrip("replay", small_dataset.path, "--targets", "psychic", code=2)
    names = "bayes, distance, distance_derivative, future_distance, gaussians, heading, impacts"
    assert f"there are: {names}" in wrong.stderr
    assert "no such" in igrip("replay", tmp_path / "no.jsonl", code=2).stderr.lower()
    small_dataset.recording(small_dataset.trials[0]).unlink()
    broken = igrip("replay", small_dataset.path, "--targets", "distance", code=1)
    assert "1 result(s) are missing" in broken.stdout
    with JsonlWriter(tmp_path / "bad.jsonl") as file:
        file.write(Observation(t=0.0))
    with (tmp_path / "bad.jsonl").open("a") as text:
        text.write('{"t": 1, "hands": {"right": {"position": [0, 0]}}}\n')
    stderr = igrip("replay", tmp_path / "bad.jsonl", code=2).stderr
    assert "hands.right: not seen once, first in line 2 (position: must be 3 numbers" in stderr
    assert "no hand and no object in 2 messages" in stderr
    assert "Traceback" not in stderr


def test_import_of_unknown_tables_is_refused(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    done = igrip("import", tmp_path / "t.csv", "--out", tmp_path / "d", code=2)
    assert "no importer recognises these files" in done.stderr
    assert "motion_capture, wispinski2021" in done.stderr
    assert "--columns map.toml" in done.stderr
    assert not (tmp_path / "d").exists()


def test_import_of_the_real_reaches(shared_data: Path, tmp_path: Path) -> None:
    done = igrip(
        "import", shared_data / "wispinski2021", "--out", tmp_path / "d", "--limit", 4,
        "--mesh", "box:0.05x0.05x0.14", "--rest", 0.5, "--noise", 0.004, "--json",
    )  # fmt: skip
    summary = json.loads(done.stdout)
    assert summary["trials"] == 4
    assert summary["derived"]["added_noise_sd_m"] == 0.004
    dataset = Dataset.open(tmp_path / "d")
    assert dataset.objects == ("ycb", "box:0.05x0.05x0.14")
    assert json.loads(igrip("replay", dataset.path, "--json").stdout)["problems"] == []


def test_names_from_outside_are_shown_as_they_are(tmp_path: Path) -> None:
    """Brackets are no markup: they may stand in ids, paths and messages."""
    assert "[/]no.jsonl: no such file" in igrip("replay", "[/]no.jsonl", code=2).stderr
    path = tmp_path / "odd.jsonl"
    mesh = {"model": MESH, "orientation": [0, 0, 0, 1], "static": True, "position": [0, 0.4, 0.05]}
    with JsonlWriter(path) as file:
        for k in range(20):
            hands = {"[red]le/ft[/]": {"position": [0.0, 0.015 * k, 0.05]}}
            file.write(Observation(t=k / 30, hands=hands, objects={"[/]": mesh} if k == 0 else {}))
    shown = igrip("replay", path, "--objects", MESH, "--targets", "distance").stdout
    assert "[red]le/ft[/]" in shown
    assert "[/]" in shown.replace("[red]le/ft[/]", "")


def test_the_error_for_a_mesh_in_millimetres_names_the_setting(
    tmp_path: Path, small_dataset: Dataset
) -> None:
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((70.0, 70.0, 200.0)).export(tmp_path / "meshes" / "carton.stl")
    recording = small_dataset.recording(small_dataset.trials[0])
    stderr = igrip("replay", recording, "--objects", tmp_path / "meshes", code=2).stderr
    assert '[carton]\nunit = "mm"' in stderr


def test_help_keeps_its_units() -> None:
    assert "[s]" in igrip("import", "--help").stdout


def test_json_is_json(tmp_path: Path) -> None:
    path = tmp_path / "far.jsonl"
    path.write_text('{"t": 0, "hands": {"right": {"position": [1e5, 0, 0]}}}\n')
    summary = json.loads(igrip("replay", path, "--json").stdout, parse_constant=pytest.fail)
    assert summary["inputs"]["hands"]["right"]["age"] is None


@pytest.mark.parametrize("option", ["--jobs=-1", "--limit=-1"])
def test_negative_numbers_are_refused(small_dataset: Dataset, option: str) -> None:
    stderr = igrip("replay", small_dataset.path, option, code=2).stderr
    assert "greater than or equal to 0" in stderr


def test_grips_prints_and_draws_the_borders(tmp_path: Path) -> None:
    out = tmp_path / "figure2.svg"
    report = json.loads(igrip("grips", "--json", "--out", out).stdout)
    # 0.85 of half the length of the longest edge: extents of 213, 102, 191 and (tilted) 254 mm
    border = report["border_m"]
    assert border["003_cracker_box"] == pytest.approx(0.85 * 0.5 * 0.2138, abs=2e-4)
    assert border["005_tomato_soup_can"] == pytest.approx(0.85 * 0.5 * 0.102, abs=2e-4)
    assert border["006_mustard_bottle"] == pytest.approx(0.85 * 0.5 * 0.1914, abs=2e-4)
    assert border["021_bleach_cleanser"] == pytest.approx(0.85 * 0.5 * 0.254, abs=2e-4)
    assert {"#5a82d8", "#d35ac0"} <= set(re.findall("#[0-9a-f]{6}", out.read_text()))


def test_bench_of_a_few_frames() -> None:
    options = ("--frames", 20, "--runs", 1, "--plain-frames", 0, "--cadence", 1)
    report = json.loads(igrip("bench", *options, "--memory-frames", 100, "--json").stdout)
    assert report["peers"]["ratios"]["update with bayes / with paper"] > 0
    assert [row["case"] for row in report["growth"]["objects"]] == [4, 100]
    assert report["memory"]["frames"] == 100
    assert set(report["cadence_30_hz"]) == {"p50_ms", "p99_ms"}
    lines = igrip("bench", *options).stdout
    assert "igrip, update at a real 30 Hz" in lines
    assert "100 objects / 4 objects: " in lines


def visit(*arguments: object) -> str:
    """Start a command that serves a page, get the page, and end it by Ctrl-C."""
    with subprocess.Popen(
        [sys.executable, "-c", "from igrip.cli import main; main()", *map(str, arguments)],
        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
        env={**os.environ, "COLUMNS": "160", "NO_COLOR": "1"},
    ) as process:  # fmt: skip
        assert process.stderr is not None
        try:
            lines = (re.search(r"http://localhost:\d+", line) for line in process.stderr)
            url = next(found for found in lines if found)
            with urllib.request.urlopen(url[0], timeout=20) as answer:
                page: str = answer.read().decode()
            process.send_signal(signal.SIGINT)
            rest = process.stderr.read()
            assert process.wait(timeout=30) == 0, rest
            assert "stopped" in rest
        finally:
            process.kill()
    return page


def test_view_serves_a_trial_until_it_is_stopped(small_dataset: Dataset) -> None:
    pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")
    assert "<html" in visit("view", small_dataset.path, "--trial", 2, "--port", 8491)


def test_grips_as_a_page() -> None:
    pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")
    assert "<html" in visit("grips", "--page", "--port", 8492)


def test_view_of_missing_things_is_refused(small_dataset: Dataset, tmp_path: Path) -> None:
    assert "no such file" in igrip("view", tmp_path / "none.jsonl", code=2).stderr
    assert (
        "trials, so none number 99"
        in igrip("view", small_dataset.path, "--trial", 99, code=2).stderr
    )
    with JsonlWriter(tmp_path / "empty.jsonl") as writer:
        writer.write(Observation(t=0.0))
    assert "no hand is measured" in igrip("view", tmp_path / "empty.jsonl", code=2).stderr
    assert (
        "no targets estimator"
        in igrip("view", small_dataset.path, "--targets", "nonsense", code=2).stderr
    )


def test_simulate_and_evaluate(tmp_path: Path) -> None:
    options = ("--participants", 2, "--trials", 2, "--no-reach", 1)
    summary = json.loads(igrip("simulate", tmp_path / "set", *options, "--json").stdout)
    assert summary["recordings"] == 9
    done = igrip("evaluate", tmp_path / "set", "--out", tmp_path / "report", "--targets", "paper")
    assert "reaches valid" in done.stdout
    assert "First commitments, all trials, reliability" in done.stdout
    assert "Predicted times: error in ms" in done.stdout
    assert (tmp_path / "report" / "report.html").is_file()
    report = json.loads((tmp_path / "report" / "summary.json").read_text())
    evaluated = report["targets"]["paper"]["all"]
    replay = json.loads(igrip("replay", tmp_path / "set", "--targets", "paper", "--json").stdout)
    [replayed] = replay["results"]  # the same numbers
    for key in ("trials", "success", "delay_s", "delay_clipped_s", "margin_s"):
        assert replayed[key] == evaluated[key]
    for part in ("40%", "60%"):
        assert replayed[f"accuracy_{part}"] == evaluated["accuracy"][part]
    assert replayed["times"] == report["targets"]["paper"]["times"]["all"]
    next((tmp_path / "set" / "recordings").iterdir()).unlink()
    again = igrip(
        "evaluate", tmp_path / "set", "--out", tmp_path / "other", "--targets", "distance",
        "--strict", "--json", code=1,
    )  # fmt: skip
    assert len(json.loads(again.stdout)["excluded"]) == 1
    assert "no recording" in again.stderr
    assert "exists already" in igrip("simulate", tmp_path / "set", code=2).stderr
    assert (
        "no profile is named 'tall'"
        in igrip("simulate", tmp_path / "new", "--profile", "tall", code=2).stderr
    )


def test_import_of_some_people_only(shared_data: Path, tmp_path: Path) -> None:
    tables, people = shared_data / "wispinski2021", tmp_path / "people.txt"
    first = pd.read_parquet(tables / "trials.parquet")["participant"].iloc[0]
    people.write_text(f"{first}\nnobody\n")
    asked = ["import", tables, "--participants", people, "--limit", 3, "--out"]
    done = json.loads(igrip(*asked, tmp_path / "d", "--json").stdout)
    assert (done["trials"], done["participants"]) == (3, 1)
    people.write_text("nobody\n")
    assert "none of these people" in igrip(*asked, tmp_path / "e", code=2).stderr
    people.unlink()
    assert "cannot be read as a list" in igrip(*asked, tmp_path / "e", code=2).stderr


def test_the_grip_selector_of_an_evaluation_is_a_choice(
    small_dataset: Dataset, tmp_path: Path
) -> None:
    bad = igrip("evaluate", small_dataset.path, "--out", tmp_path / "r", "--grips", "x", code=2)
    assert "no grip selector is named 'x'" in bad.stderr.replace("\n", " ")
    for grips in ("cylinder", "contact"):
        igrip("evaluate", small_dataset.path, "--out", tmp_path / grips, "--grips", grips,
              "--targets", "bayes")  # fmt: skip
    both = [pd.read_parquet(tmp_path / g / "trials.parquet") for g in ("cylinder", "contact")]
    assert both[0]["success"].tolist() == both[1]["success"].tolist()
