"""Datasets written by others: what is wrong is found, and spellings are matched."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from datasets import MESH, write_small_dataset
from igrip import Observation, load_objects
from igrip.errors import DatasetError, RecordingError
from igrip.io.datasets.check import check_trial, unused_recordings
from igrip.io.datasets.dataset import Dataset
from igrip.io.frames import DeclaredFrame
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.trial_rows import score_run


def rewritten(tmp_path: Path, old: str, new: str, encoding: str = "utf-8") -> Dataset:
    """Return a small dataset with a change in its table of trials."""
    write_small_dataset(tmp_path / "d")
    table = tmp_path / "d" / "trials.tsv"
    text = table.read_text()
    assert old in text
    table.write_bytes(text.replace(old, new).encode(encoding))
    return Dataset.open(tmp_path / "d", lenient=True)


def flaws(dataset: Dataset) -> list[tuple[str, str]]:
    models = load_objects(*dataset.objects)
    return [flaw for trial in dataset.trials for flaw in check_trial(dataset, trial, models)]


def errors(dataset: Dataset) -> list[str]:
    return [text for verdict, text in flaws(dataset) if verdict == "error"]


def test_a_good_dataset_has_no_flaws(tmp_path):
    dataset = write_small_dataset(tmp_path / "d")
    assert errors(dataset) == []
    assert unused_recordings(dataset) == []


NAMES = [
    "reach0.jsonl", "recordings/reach0.jsonl", "recordings/reach0", "./recordings/reach0.jsonl",
    "recordings\\reach0.jsonl", "reach0.JSONL", "Reach0",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_recordings_by_name_file_or_path(tmp_path, name):
    dataset = rewritten(tmp_path, "reach0", name)
    assert dataset.recording(dataset.trials[0]).name == "reach0.jsonl"
    assert errors(dataset) == []


@pytest.mark.parametrize("name", [
    "P01/reach0", "recordings/P01/reach0.jsonl", "P01\\reach0.jsonl", "p01/Reach0", "reach0",
])  # fmt: skip
def test_recordings_in_a_folder_for_each_person(tmp_path, name):
    dataset = rewritten(tmp_path, "reach0", name)
    folder = dataset.path / "recordings"
    (folder / "P01").mkdir()
    (folder / "reach0.jsonl").rename(folder / "P01" / "reach0.jsonl")
    assert dataset.recording(dataset.trials[0]) == folder / "P01" / "reach0.jsonl"
    assert errors(dataset) == []
    assert unused_recordings(dataset) == []


def test_a_name_in_two_folders_is_no_name(tmp_path):
    dataset = rewritten(tmp_path, "reach0", "reach0")
    folder = dataset.path / "recordings"
    text = (folder / "reach0.jsonl").read_bytes()
    (folder / "reach0.jsonl").unlink()
    for person in ("P01", "P02"):
        (folder / person).mkdir()
        (folder / person / "reach0.jsonl").write_bytes(text)
    with pytest.raises(RecordingError, match=r"no recording 'reach0'.*P01/reach0, P02/reach0"):
        dataset.recording(dataset.trials[0])


@pytest.mark.parametrize(
    "name",
    ["recordings/../../etc/passwd", "recordings/P01/../../x", "/etc/passwd", "recordings/.hidden"],
)
def test_recordings_stay_in_their_folder(tmp_path, name):
    dataset = rewritten(tmp_path, "reach0", name)
    with pytest.raises(DatasetError, match="cannot be named"):
        dataset.recording(dataset.trials[0])


def test_a_recording_that_is_missing_is_named_with_what_is_there(tmp_path):
    dataset = rewritten(tmp_path, "reach0", "reach00")
    with pytest.raises(RecordingError, match="no recording 'reach00'; did you mean 'reach"):
        dataset.recording(dataset.trials[0])
    assert unused_recordings(dataset) == ["reach0.jsonl"]


@pytest.mark.parametrize("hand", ["Right", "R", "right_hand", "RIGHT"])
def test_hands_in_other_spellings_are_scored(tmp_path, hand):
    dataset = rewritten(tmp_path, "\tright\t", f"\t{hand}\t")
    catalog = load_objects(MESH)
    from igrip import Config

    rows = score_run(run_trial(dataset, dataset.trials[0], catalog, [Config()]))
    assert "never seen" not in str(rows[0]["remark"])
    assert rows[0]["hand"] == "right"
    assert rows[0]["success"] is True
    assert all(verdict == "remark" for verdict, _ in flaws(dataset))


BROKEN = [
    ("\tright\t", "\thand_0\t", "'hand_0' was never seen; the recording has 'right'"),
    ("\tright\t", "\t\t", "its hand is not known; the recording has 'right'"),
    ("\tnear\t", "\tNear\t", "target 'Near' never appears; did you mean 'near'"),
    ("\tnear\t", "\tn/a\t", "its target is not known; there are 'near', 'far'"),
    ("\t1.0\t2.0", "\t1.0\t20.0", "end_s 20 s is outside the recording"),
    ("\t1.0\t2.0", "\tsoon\t2.0", "'soon' is no time"),
]


@pytest.mark.parametrize(("old", "new", "words"), BROKEN)
def test_what_cannot_be_scored(tmp_path, old, new, words):
    dataset = rewritten(tmp_path, old, new)
    assert words in " ".join(text for verdict, text in flaws(dataset) if verdict == "error")


@pytest.mark.parametrize("cells", ["\t1,0\t2,0", "\t1.000\t2", "\tn/a\tn/a", "\tN/A\t"])
def test_times_in_other_spellings(tmp_path, cells):
    dataset = rewritten(tmp_path, "\t1.0\t2.0", cells)
    assert [trial.problem for trial in dataset.trials] == [None, None]
    known = "1" in cells
    assert (dataset.trials[0].onset_s, dataset.trials[0].end_s) == (
        (1.0, 2.0) if known else (None,) * 2
    )


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_tables_in_other_encodings(tmp_path, encoding):
    dataset = rewritten(tmp_path, "\tp1\t", "\tJörg\t", encoding)
    assert {trial.participant for trial in dataset.trials} == {"Jörg"}


@pytest.mark.parametrize("separator", [",", ";"])
def test_a_table_with_other_separators(tmp_path, separator):
    write_small_dataset(tmp_path / "d")
    table = tmp_path / "d" / "trials.tsv"
    table.write_text(table.read_text().replace("\t", separator))
    assert [trial.target for trial in Dataset.open(tmp_path / "d").trials] == ["near", "far"]


def test_no_trials_is_an_error(tmp_path):
    write_small_dataset(tmp_path / "d")
    table = tmp_path / "d" / "trials.tsv"
    table.write_text(table.read_text().splitlines()[0] + "\n")
    with pytest.raises(DatasetError, match=r"trials\.tsv: has no trials"):
        Dataset.open(tmp_path / "d")
    table.rename(tmp_path / "d" / "trials.csv")
    with pytest.raises(DatasetError, match=r"trials\.tsv: is missing; found .*trials\.csv"):
        Dataset.open(tmp_path / "d")


def test_a_damaged_recording_is_named_with_its_place(tmp_path):
    dataset = write_small_dataset(tmp_path / "d")
    path = dataset.recording(dataset.trials[0])
    path.write_text("")
    assert flaws(dataset)[0] == ("error", "the recording is empty")


def test_models_that_are_not_known(tmp_path):
    dataset = write_small_dataset(tmp_path / "d")
    found = [
        f for trial in dataset.trials for f in check_trial(dataset, trial, ["cylinder:0.03x0.13"])
    ]
    assert "did you mean 'cylinder:0.03x0.13'" in " ".join(flaw.text for flaw in found)


FRAMES = [
    {"up": "y", "length_unit": "mm", "time_unit": "ms"},
    {"axes": ["-y", "x", "z"], "quaternions": "wxyz"},
    {"up": "y", "handedness": "left"},
]


@pytest.mark.parametrize("declared", FRAMES)
def test_a_declared_frame_is_converted(tmp_path, declared):
    """The recordings are written in the frame by its inverse, and read as they were."""
    dataset = write_small_dataset(tmp_path / "d")
    expected = [list(dataset.observations(trial)) for trial in dataset.trials]
    frame = DeclaredFrame.declare(**declared)
    for trial, messages in zip(dataset.trials, expected, strict=True):
        lines = []
        for m in messages:
            hands = {id: {"position": _source(frame, h.position)} for id, h in m.hands.items()}
            objects = {
                id: {"model": o.model, "static": True, "position": _source(frame, o.position),
                     "orientation": _source_turn(frame, o.orientation)}
                for id, o in m.objects.items()
            }  # fmt: skip
            lines.append(Observation(t=m.t / frame.seconds, hands=hands, objects=objects).to_json())
        dataset.recording(trial).write_bytes(b"\n".join(lines))
    path = tmp_path / "d" / "dataset.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"frame": declared}))
    again = Dataset.open(tmp_path / "d")
    assert again.frame == frame
    for trial, messages in zip(again.trials, expected, strict=True):
        for ours, theirs in zip(again.observations(trial), messages, strict=True):
            assert ours.t == pytest.approx(theirs.t, abs=1e-9)
            for id, hand in theirs.hands.items():
                assert ours.hands[id].position == pytest.approx(hand.position, abs=1e-9)
            for id, pose in theirs.objects.items():
                assert ours.objects[id].position == pytest.approx(pose.position, abs=1e-9)
                turn = np.dot(ours.objects[id].orientation, pose.orientation)
                assert abs(turn) == pytest.approx(1.0, abs=1e-9)


def _source(frame, position):
    return (np.linalg.inv(frame.matrix) @ np.array(position) / frame.metres).tolist()


def _source_turn(frame, orientation):
    """Return the quaternion whose conversion is the given one, by solving for it."""
    basis = np.array([frame.orientations(row) for row in np.eye(4)])  # linear in the quaternion
    return np.linalg.solve(basis.T, np.array(orientation)).tolist()


@pytest.mark.parametrize("frame", [{"up": "w"}, {"ups": "z"}, 3, {"length_unit": "mile"}])
def test_a_frame_that_is_none_is_named(tmp_path, frame):
    dataset = write_small_dataset(tmp_path / "d")
    path = tmp_path / "d" / "dataset.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"frame": frame}))
    with pytest.raises(DatasetError, match=r"dataset\.json: frame"):
        Dataset.open(tmp_path / "d").observations(dataset.trials[0])


@pytest.mark.parametrize("grip", ["Palmar", "palmer", "PALMAR"])
def test_a_grip_that_is_nearly_one_is_named(tmp_path, grip):
    dataset = rewritten(tmp_path, "\tright\tnear\t\t", f"\tright\tnear\t{grip}\t")
    assert any(f"{grip!r}" in text and "mean 'palmar'" in text for _, text in flaws(dataset))
