"""Recordings by their ending."""

import errno
import json
import sys

import pytest

import igrip
from igrip import Intention, Observation
from igrip.errors import MissingExtraError, RecordingError
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings.files import open_recording, open_writer
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.io.recordings.mcap_writer import McapReader, McapWriter
from igrip.lab.evaluation.runner import run_trial


@pytest.mark.parametrize(
    ("name", "reader", "writer"),
    [
        ("a.jsonl", JsonlReader, JsonlWriter),
        ("a.MCAP", McapReader, McapWriter),
        ("a.mcap", McapReader, McapWriter),
        ("a.txt", JsonlReader, JsonlWriter),
    ],
)
def test_by_ending(tmp_path, name, reader, writer):
    with open_writer(tmp_path / name) as file:
        assert isinstance(file, writer)
        file.write(Observation(t=1.0), trial=3)
    again = open_recording(tmp_path / name)
    assert isinstance(again, reader)
    assert list(again) == [Observation(t=1.0)]


def test_further_fields_of_an_intention(tmp_path):
    told = Intention(t=1.0, hand="right", status="idle")
    lines = {}
    for name in ("a.jsonl", "a.mcap"):
        with open_writer(tmp_path / name) as file:
            file.write(told, recording="x")
    lines["a.jsonl"] = (tmp_path / "a.jsonl").read_bytes().strip()
    [record] = McapReader(tmp_path / "a.mcap").records(("/intentions",))
    lines["a.mcap"] = record.data
    assert lines["a.jsonl"] == lines["a.mcap"]
    assert json.loads(lines["a.mcap"]) == told.to_dict() | {"recording": "x"}


def test_a_dataset_of_mcap_is_the_dataset_of_jsonl(small_dataset):
    """Its trials are found, and judged the same to the last bit."""
    catalog = igrip.load_objects(*small_dataset.objects)
    config = igrip.Config(targets="paper")

    def judged():
        dataset = Dataset.open(small_dataset.path)
        runs = [run_trial(dataset, trial, catalog, [config]) for trial in dataset.trials]
        return [(run.problem, run.recorded, run.estimators[0].intentions) for run in runs]

    before = judged()
    for trial in small_dataset.trials:
        path = small_dataset.recording(trial)
        with McapWriter(path.with_suffix(".mcap")) as file:
            for observation in JsonlReader(path):
                file.write(observation)
        path.unlink()
    after = judged()
    assert after == before
    assert repr(after) == repr(before)
    assert before[0][0] is None


@pytest.mark.parametrize("make", [McapReader, McapWriter])
def test_a_missing_package(tmp_path, monkeypatch, make):
    monkeypatch.setitem(sys.modules, "mcap.records", None)
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'igrip\[mcap\]'"):
        make(tmp_path / "a.mcap")
    assert not (tmp_path / "a.mcap").exists()


def test_lines_on_a_full_disk(tmp_path):
    writer = JsonlWriter(tmp_path / "a.jsonl")
    real = writer._file

    class Full:
        def write(self, data):
            raise OSError(errno.ENOSPC, "No space left on device")

    writer._file = Full()
    with pytest.raises(RecordingError, match="No space left on device; what was recorded"):
        writer.write(Observation(t=1.0))
    real.close()
