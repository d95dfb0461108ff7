"""``igrip import --inspect`` and ``igrip check``, as a user sees them."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import mocap_files
import plain_tables as plain
from datasets import write_small_dataset
from igrip.cli.app import app
from igrip.io.datasets.dataset import Dataset
from mocap_files import Body, Scene

runner = CliRunner()


def igrip(*arguments, code=0):
    result = runner.invoke(app, [str(argument) for argument in arguments])
    if code is not None:
        assert result.exit_code == code, result.output + repr(result.exception)
    return result


def one_line(text):
    return " ".join(text.split())


@pytest.fixture
def motive(tmp_path):
    table = plain.samples()
    turned = np.tile([0.0, 0.0, 0.0, 1.0], (len(table), 1))
    hand = table[:, 1:] / 1000.0
    hand[120:140] = np.nan
    mug = np.tile([-0.1, 0.4, 0.06], (len(table), 1))
    scene = Scene(table[:, 0], {"Right Hand": Body(hand, turned), "025_mug": Body(mug, turned)})
    return mocap_files.motive(tmp_path / "take 1.csv", scene)


def test_inspect_shows_what_is_understood_and_writes_nothing(tmp_path, motive):
    before = set(tmp_path.iterdir())
    shown = igrip("import", "--inspect", motive).output
    for words in ("OptiTrack Motive CSV 1.23", "decimal point", "100 samples a second, 2 s",
                  "lengths in mm", "Right Hand", "025_mug", "181", "20", "right: Right Hand",
                  "from above"):  # fmt: skip
        assert words in shown
    assert set(tmp_path.iterdir()) == before


def test_inspect_as_json(motive):
    [found] = json.loads(igrip("import", "--inspect", motive, "--json").stdout)
    assert found["hands"] == {"right": "Right Hand"}
    assert found["rate_hz"] == pytest.approx(100.0)
    hand = found["bodies"]["Right Hand"]
    assert (hand["samples"], hand["missing"], hand["turns"]) == (181, 20, True)
    assert found["frame"]["axes"] == ["x", "-z", "y"]


def test_the_map_that_is_written_imports_the_file(tmp_path, motive):
    igrip("import", "--inspect", motive, "--write-map", tmp_path / "map.toml")
    igrip("import", motive, "--columns", tmp_path / "map.toml", "--out", tmp_path / "out")
    direct = igrip("import", motive, "--out", tmp_path / "direct")
    assert "1 trials of 1 participants" in direct.output
    [ours] = (tmp_path / "out" / "recordings").iterdir()
    [theirs] = (tmp_path / "direct" / "recordings").iterdir()
    first = json.loads(ours.read_text().splitlines()[0])
    again = json.loads(theirs.read_text().splitlines()[0])
    assert first["hands"] == again["hands"]
    assert first["objects"].keys() == again["objects"].keys()
    assert again["objects"]["025_mug"]["model"] == "025_mug"  # a body named as a model is that


def test_the_map_of_a_plain_table(tmp_path):
    folder = plain.write(tmp_path / "in", plain.lines(plain.samples()))
    igrip("import", "--inspect", folder / "take1.csv", "--unit", "mm", "--write-map",
          tmp_path / "map.toml")  # fmt: skip
    igrip("import", folder / "take1.csv", "--columns", tmp_path / "map.toml", "--out",
          tmp_path / "out")  # fmt: skip
    [recording] = (tmp_path / "out" / "recordings").iterdir()
    [hand] = json.loads(recording.read_text().splitlines()[0])["hands"].values()
    assert hand["position"] == pytest.approx(plain.samples()[0, 1:] / 1000.0, abs=1e-3)


def test_a_map_is_not_overwritten(tmp_path, motive):
    (tmp_path / "map.toml").write_text("precious")
    result = igrip("import", "--inspect", motive, "--write-map", tmp_path / "map.toml", code=2)
    assert "map.toml: exists already" in one_line(result.stderr)
    assert (tmp_path / "map.toml").read_text() == "precious"


def test_inspect_of_what_cannot_be_used(tmp_path):
    (tmp_path / "notes.txt").write_text("nothing but words\n")
    shown = igrip("import", "--inspect", tmp_path / "notes.txt", code=None)
    assert "no columns of x, y and z were found" in shown.output
    (tmp_path / "empty").mkdir()
    result = igrip("import", "--inspect", tmp_path / "empty", code=2)
    assert "no table and no C3D file; found nothing" in one_line(result.stderr)


def test_an_unknown_table_is_answered_with_the_ways_out(tmp_path):
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    result = igrip("import", tmp_path / "t.csv", "--out", tmp_path / "out", code=2)
    for words in ("motion_capture", "wispinski2021", "--columns", "--inspect", "docs/importing.md"):
        assert words in one_line(result.stderr)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--up", "w"], "up"),
        (["--unit", "mile"], "length_unit"),
        (["--axes", "x,x,z"], "axis twice"),
    ],
)
def test_a_frame_that_is_none(tmp_path, motive, options, words):
    result = igrip("import", motive, "--out", tmp_path / "out", *options, code=2)
    assert words in one_line(result.stderr)


def test_check_of_a_good_and_a_bad_dataset(tmp_path):
    write_small_dataset(tmp_path / "d")
    assert "2 of 2 trials can be scored" in igrip("check", tmp_path / "d").output
    table = tmp_path / "d" / "trials.tsv"
    table.write_text(table.read_text().replace("\tnear\t", "\tnearby\t", 1))
    shown = igrip("check", tmp_path / "d", code=1).output
    assert "1 of 2 trials can be scored" in shown
    assert "nearby" in shown
    found = json.loads(igrip("check", tmp_path / "d", "--json", code=1).stdout)
    assert (found["trials"], found["failed"]) == (2, 1)
    assert found["flaws"][0]["recording"] == "reach0"


def test_a_mesh_in_millimetres_and_a_table_become_a_dataset_by_the_written_map(tmp_path):
    """As in docs/meshes.md: the map needs only the target and the place of the object."""
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    trimesh.creation.cylinder(radius=40, height=95).export(meshes / "mug.stl")
    (meshes / "objects.toml").write_text('[mug]\nunit = "mm"\n')
    part = np.clip((np.arange(200) - 50) / 100, 0.0, 1.0)
    part = 10 * part**3 - 15 * part**4 + 6 * part**5
    rows = [f"{k},{200 - 150 * p:.1f},{350 * p:.1f},{50 + 40 * p:.1f}" for k, p in enumerate(part)]
    take, found = tmp_path / "take1.csv", tmp_path / "map.toml"
    take.write_text("\n".join(["frame,palm x,palm y,palm z", *rows]) + "\n")
    igrip("import", "--inspect", take, "--unit", "mm", "--input-rate", 100, "--write-map", found)
    text = found.read_text()
    assert tomllib.loads(text)["rate"] == 100.0
    text = text.replace('# target = "=mug"', 'target = "=mug"')
    found.write_text(text + '\n[objects.mug]\nmodel = "mug"\nx = 50.0\ny = 400.0\nz = 47.5\n')
    igrip("import", take, "--columns", found, "--objects", meshes, "--out", tmp_path / "ours")
    (trial,) = Dataset.open(tmp_path / "ours").trials
    assert (trial.hand, trial.target) == ("right", "mug")
