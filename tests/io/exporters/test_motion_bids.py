"""Motion-BIDS: the official validator finds no error, and other readers find what was recorded."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from datasets import MESH, PLACES, write_small_dataset
from igrip import Observation
from igrip.errors import DatasetError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.io.exporters import EXPORTERS
from igrip.io.takes.files import open_file


def export(dataset: Dataset, folder: Path) -> list[str]:
    folder.mkdir()
    counted: list[None] = []
    problems = EXPORTERS.get("motion_bids")(dataset, folder, lambda: counted.append(None))
    assert len(counted) == len(dataset.trials)
    return problems


def validate(folder: Path) -> dict:
    """Return what the validator of BIDS says, JSON."""
    found = subprocess.run(
        [Path(sys.executable).with_name("bids-validator-deno"), "--format", "json", folder],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    return json.loads(found.stdout)


def run_of(folder: Path, number: int, subject: str = "p1", camera: str = "camera") -> Path:
    name = f"sub-{subject}_task-reach_tracksys-{camera}_run-{number:03d}_motion.tsv"
    return folder / f"sub-{subject}" / "motion" / name


def test_the_validator_finds_no_error(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    assert export(dataset, tmp_path / "bids") == []
    issues = validate(tmp_path / "bids")["issues"]["issues"]
    assert [one for one in issues if one["severity"] == "error"] == []
    (run_of(tmp_path / "bids", 2)).with_suffix(".json").unlink()  # and it would find one
    issues = validate(tmp_path / "bids")["issues"]["issues"]
    assert [one for one in issues if one["severity"] == "error"] != []


def test_the_numbers_are_those_of_the_recording(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    export(dataset, tmp_path / "bids")
    path = run_of(tmp_path / "bids", 1)
    channels = pd.read_csv(str(path).replace("_motion.tsv", "_channels.tsv"), sep="\t")
    table = pd.read_csv(path, sep="\t", header=None, names=list(channels["name"]))
    messages = list(dataset.observations(dataset.trials[0]))
    np.testing.assert_allclose(
        table[[f"hand_right_{axis}" for axis in "xyz"]],
        [message.hands["right"].position for message in messages], rtol=1e-8,
    )  # fmt: skip
    np.testing.assert_allclose(table["latency"], [m.t - messages[0].t for m in messages], rtol=1e-8)
    for id, place in PLACES.items():  # reported once, static: there all the time
        assert np.allclose(table[[f"object_{id}_{axis}" for axis in "xyz"]], place)
        assert (table[f"object_{id}_qw"] == 1).all()
    events = pd.read_csv(str(path).replace("_motion.tsv", "_events.tsv"), sep="\t")
    movement = events.set_index("trial_type").loc["movement"]
    assert (movement["onset"], movement["duration"], movement["target"]) == (1.0, 1.0, "near")


def test_igrip_reads_it_again(tmp_path):
    export(write_small_dataset(tmp_path / "small"), tmp_path / "bids")
    table = open_file(run_of(tmp_path / "bids", 2))
    assert (table.layout.name, table.layout.rate, table.layout.length_unit) == (
        "Motion-BIDS", pytest.approx(30.0), "m",
    )  # fmt: skip
    assert {body.name for body in table.layout.bodies} == {
        "hand_right", "object_near", "object_far",
    }  # fmt: skip


def test_what_is_not_seen_is_not_available(tmp_path):
    writer = DatasetWriter(tmp_path / "gaps", "Gaps", "MIT", "by hand", objects=[MESH])
    pose = {"model": MESH, "orientation": [0, 0, 0, 1], "position": [0.3, 0, 0]}
    seen = {"right": {"position": [0.1, 0.2, 0.3]}}
    messages = [
        Observation(t=0.0, hands=seen, objects={"a": pose, "b": {**pose, "static": True}}),
        Observation(t=0.1, hands={"right": None}, objects={}),
        Observation(t=0.2, hands=seen, objects={"b": None}),
    ]
    writer.add(Trial("one", "P 1", "1", hand="right", target="a"), messages)
    export(writer.close(), tmp_path / "bids")
    rows = run_of(tmp_path / "bids", 1, "P1").read_text().splitlines()
    cells = [row.split("\t") for row in rows]
    assert [row[1] == "n/a" for row in cells] == [False, True, False]  # the hand
    assert [row[4] == "n/a" for row in cells] == [False, True, True]  # seen once, not static
    assert [row[11] == "n/a" for row in cells] == [False, False, True]  # static, then gone


def test_nothing_that_names_a_person_gets_out(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    secret = "Kowalska"
    (dataset.path / "participants.tsv").write_text(
        f"participant\tname\tconsent\tage\nsub-p1\t{secret}\t2026-01-31\t41\n"
    )
    rows = (dataset.path / "trials.tsv").read_text().splitlines()
    rows = [f"{rows[0]}\tcomment", *(f"{row}\tMrs {secret}" for row in rows[1:])]
    (dataset.path / "trials.tsv").write_text("\n".join(rows) + "\n")
    export(Dataset.open(dataset.path), tmp_path / "bids")
    texts = [path.read_text() for path in (tmp_path / "bids").rglob("*.*") if path.is_file()]
    assert not any(secret in text or "2026" in text for text in texts)


def test_two_participants_with_one_label_are_refused(tmp_path):
    writer = DatasetWriter(tmp_path / "two", "Two", "MIT", "by hand", objects=[MESH])
    for k, name in enumerate(("P-1", "P1")):
        writer.add(Trial(f"r{k}", name, "1"), [])
    with pytest.raises(DatasetError, match="P-1, P1 have the same letters and digits"):
        export(writer.close(), tmp_path / "bids")


def test_a_recording_that_cannot_be_read_is_left_out_and_named(tmp_path):
    dataset = write_small_dataset(tmp_path / "small")
    dataset.recording(dataset.trials[0]).write_text("no recording\n")
    problems = export(dataset, tmp_path / "bids")
    assert len(problems) == 1
    assert problems[0].startswith("reach0: ")
    assert run_of(tmp_path / "bids", 2).exists()
    assert not run_of(tmp_path / "bids", 1).exists()
