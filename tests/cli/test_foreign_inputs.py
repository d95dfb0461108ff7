"""Inputs of other tools through ``igrip replay`` and ``igrip stream``: what each row asks for."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from datasets import write_small_dataset
from igrip.cli.app import app

INPUTS = Path(__file__).parents[3] / "shared" / "inputs"
needs_inputs = pytest.mark.skipif(not INPUTS.is_dir(), reason="../shared/inputs is not there")

SEEN = [  # file, what is counted, where first, and the words for it; the target is mustard
    ("lost-told/nanhand.jsonl", "hands.right", "line 21", "not seen 3 times"),
    ("lost-told/nanleft.jsonl", "hands.left", "line 1", "not seen 64 times"),
    ("lost-told/nanscore.jsonl", "objects.mustard.score", "line 1", "left out 64 times"),
    ("lost-told/zeroquat.jsonl", "objects.box", "line 1", "not seen 64 times"),
    ("times/step_ntp.jsonl", "t", "line 31", "steps back by 0.4 s and stays there"),
    ("times/negative.jsonl", "t", "line 1", "is -0.5 s"),
    ("text/utf16.jsonl", "", "", ""),
    ("text/bom_once.jsonl", "", "", ""),
]


def replay(path, *options):
    return CliRunner().invoke(app, ["replay", str(path), *map(str, options)])


def stream(path, *options):
    command = [sys.executable, "-m", "igrip", "stream", "--in", "stdin", "--out", "stdout"]
    with path.open("rb") as file:
        return subprocess.run(
            [*command, *options], stdin=file, capture_output=True, text=True, check=False
        )


@needs_inputs
@pytest.mark.parametrize(("name", "path", "place", "words"), SEEN)
def test_what_is_damaged_costs_itself_and_is_named(name, path, place, words):
    done = replay(INPUTS / name, "--json")
    assert done.exit_code == 0
    summary = json.loads(done.stdout)
    assert summary["messages"] == 64
    assert [reach["target"] for reach in summary["hands"]["right"]["reaches"]] == ["mustard"]
    assert path in done.stderr
    assert place in done.stderr
    assert words in done.stderr


@needs_inputs
@pytest.mark.parametrize("name", ["lost-told/nanleft.jsonl", "lost-told/zeroquat.jsonl",
                                  "text/utf16.jsonl", "times/negative.jsonl"])  # fmt: skip
def test_what_is_piped_in_gives_the_intentions_of_a_replay(name, tmp_path):
    done = stream(INPUTS / name)
    assert done.returncode == 0
    replayed = tmp_path / "out.jsonl"
    assert replay(INPUTS / name, "--out", replayed).exit_code == 0
    wire = {"session", "seq", "sent", "age", "valid_for"}
    piped = [{k: v for k, v in json.loads(line).items() if k not in wire}
             for line in done.stdout.splitlines()]  # fmt: skip
    assert piped == [json.loads(line) for line in replayed.read_text().splitlines()]


@needs_inputs
def test_a_step_back_of_a_piped_clock_is_followed_and_named():
    done = stream(INPUTS / "times/step_ntp.jsonl")
    assert done.returncode == 0
    assert "stepped back by 0.367 s" in done.stderr
    assert json.loads(done.stdout.splitlines()[-1])["target"] == "mustard"


@needs_inputs
def test_milliseconds_are_refused_with_their_option_and_read_with_it():
    path = INPUTS / "times/ms.jsonl"
    refused = replay(path)
    assert refused.exit_code
    assert "steps of 33.3 s: are these ms? If so, declare it: --time-unit ms" in refused.stderr
    taken = replay(path, "--time-unit", "ms")
    assert taken.exit_code == 0
    assert "mustard" in taken.stdout


@needs_inputs
def test_milliseconds_that_are_piped_in_are_refused_too():
    refused = stream(INPUTS / "times/ms.jsonl")
    assert refused.returncode
    assert "steps of 33.3 s: are these ms? (--time-unit ms)" in refused.stderr
    taken = stream(INPUTS / "times/ms.jsonl", "--time-unit", "ms")
    assert taken.returncode == 0
    assert "mustard" in taken.stdout


@needs_inputs
def test_a_bag_of_transforms_is_read_and_what_it_lacks_is_named():
    done = replay(INPUTS / "mcap/ros2_tf.mcap")
    assert done.exit_code == 0
    assert "no object was seen" in done.stderr


def write(path, messages):
    path.write_text("".join(json.dumps(message) + "\n" for message in messages))
    return path


def reach(scale=1.0, turn=lambda p: p):
    objects = {"mustard": {"model": "006_mustard_bottle", "orientation": [0, 0, 0, 1],
                           "position": turn([0.0, 0.4 * scale, 0.0])}}  # fmt: skip
    for k in range(60):
        position = turn([0.2 * scale, 0.005 * k * scale, 0.05 * scale])
        yield {"t": k / 30, "hands": {"right": {"position": position}}, "objects": objects}


def test_millimetres_are_refused_with_their_option_and_read_with_it(tmp_path):
    path = write(tmp_path / "mm.jsonl", reach(1000.0))
    done = replay(path)
    assert done.exit_code
    assert "--length-unit mm" in done.stderr
    assert replay(path, "--length-unit", "mm").exit_code == 0


def test_a_world_with_y_up_is_remarked_and_can_be_declared(tmp_path):
    path = write(tmp_path / "y.jsonl", reach())
    half = 0.5**0.5
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:  # y up: the mesh, whose top is its z, is turned by -90 degrees about x
        for entity in (*line["hands"].values(), *line["objects"].values()):
            x, y, z = entity["position"]
            entity["position"] = [x, z, -y]
        line["objects"]["mustard"]["orientation"] = [-half, 0, 0, half]
    done = replay(write(path, lines))
    assert "--up y" in done.stderr or "up = y" in done.stderr
    upright = replay(write(tmp_path / "z.jsonl", reach()), "--json")
    declared = replay(path, "--up", "y", "--json")
    a, b = (json.loads(one.stdout)["hands"]["right"]["reaches"] for one in (upright, declared))
    assert [r["target"] for r in a] == [r["target"] for r in b] == ["mustard"]


def test_a_recording_without_messages_is_an_error(tmp_path):
    (tmp_path / "none.jsonl").write_text("\n")
    done = replay(tmp_path / "none.jsonl")
    assert done.exit_code
    assert "holds no messages" in done.stderr


def test_a_hand_in_another_spelling_than_the_assisted_one_is_named(tmp_path):
    messages = [m | {"hands": {"Right": m["hands"]["right"]}} for m in reach()]
    done = stream(write(tmp_path / "right.jsonl", messages), "--assisted", "right")
    assert done.returncode == 0
    assert "hand 'Right' gets no commitment: --assisted Right" in done.stderr


def test_what_a_stream_survives_an_evaluation_survives(tmp_path):
    path = write_small_dataset(tmp_path / "small").path
    whole = evaluate(path, tmp_path / "whole")
    for recording in (path / "recordings").iterdir():
        lines = [json.loads(line) for line in recording.read_text().splitlines()]
        for k, line in enumerate(lines):
            line["t"] -= 0.5  # counted from a trigger
            if k % 20 == 7:
                line["hands"]["left"] = {"position": [float("nan")] * 3}
        texts = [json.dumps(line) for line in lines]
        texts[10:10] = ["{", "no message"]
        recording.write_text("\r\n".join(texts), encoding="utf-16")
    table = path / "trials.tsv"
    rows = [row.split("\t") for row in table.read_text().splitlines()]
    for row in rows[1:]:
        for name in ("onset_s", "end_s"):
            at = rows[0].index(name)
            row[at] = str(float(row[at]) - 0.5)
    table.write_text("".join("\t".join(row) + "\n" for row in rows))
    damaged = evaluate(path, tmp_path / "damaged")
    for key in ("target", "success", "problem"):
        assert [row[key] for row in damaged] == [row[key] for row in whole]
    for row in damaged:
        assert "hands.left: not seen" in row["remark"]
        assert "messages: skipped 2 times, first in line 11" in row["remark"]


def evaluate(path, out):
    """Return the rows of an evaluation."""
    done = CliRunner().invoke(app, ["evaluate", str(path), "--out", str(out), "--jobs", "1"])
    assert done.exit_code == 0, done.output
    return pd.read_parquet(out / "trials.parquet").to_dict("records")
