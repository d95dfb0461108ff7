"""Recordings and live sources are opened by their ending or scheme."""

import errno
import json
import sys

import pytest

import igrip
from igrip import Intention, Observation
from igrip.errors import MissingExtraError, RecordingError, UnknownNameError
from igrip.io.datasets.dataset import Dataset
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter
from igrip.io.recordings import SOURCES, open_writer
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.lab.evaluation.replay import replay_run
from igrip.lab.evaluation.runner import run_trial

FORMATS = [
    ("a.jsonl", JsonlReader, JsonlWriter),
    ("a.MCAP", McapReader, McapWriter),
    ("a.mcap", McapReader, McapWriter),
]


@pytest.mark.parametrize(("name", "reader", "writer"), FORMATS)
def test_by_ending(tmp_path, name, reader, writer):
    with open_writer(tmp_path / name) as file:
        assert isinstance(file, writer)
        file.write(Observation(t=1.0), trial=3)
    again = igrip.open_source(tmp_path / name)
    assert isinstance(again, reader)
    assert list(again) == [Observation(t=1.0)]


@pytest.mark.parametrize(("form", "reader", "writer"), [("jsonl", *FORMATS[0][1:]),
                                                        ("mcap", *FORMATS[2][1:])])  # fmt: skip
def test_a_format_reads_and_writes_files_with_any_ending(tmp_path, form, reader, writer):
    name = f"{form}:{tmp_path / 'a.txt'}"
    with open_writer(name) as file:
        assert isinstance(file, writer)
        file.write(Observation(t=1.0))
    assert (tmp_path / "a.txt").exists()
    again = igrip.open_source(name)
    assert isinstance(again, reader)
    assert list(again) == [Observation(t=1.0)]


@pytest.mark.parametrize("name", ["reach.txt", "reach", "ws://host:1", "oak:", "", ".", "jsonl"])
@pytest.mark.parametrize(
    ("open_it", "family"), [(igrip.open_source, "source"), (open_writer, "recording format")]
)
def test_unknown_endings_and_schemes(tmp_path, monkeypatch, name, open_it, family):
    """Nothing is read or written as a guess; the error lists what is valid."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UnknownNameError) as raised:
        open_it(name)
    assert (raised.value.family, raised.value.name) == (family, name)
    assert {".jsonl", ".mcap", "jsonl:…"} <= set(raised.value.choices)
    assert ", ".join(raised.value.choices) in str(raised.value)
    assert (".db3" in raised.value.choices) == (family == "source")  # bags can only be read
    assert not list(tmp_path.iterdir())


def test_a_recording_that_is_not_there(tmp_path):
    with pytest.raises(RecordingError, match=r"nothing\.jsonl"):
        igrip.open_source(tmp_path / "nothing.jsonl")


def test_a_third_party_scheme_gets_the_whole_name(monkeypatch):
    opened = []
    monkeypatch.setitem(SOURCES._members, "toy", lambda name: opened.append(name) or [1, 2])
    assert igrip.open_source("toy:left/a.jsonl") == [1, 2]
    assert opened == ["toy:left/a.jsonl"]
    with pytest.raises(RecordingError, match="toy:left: this source can only be read"):
        open_writer("toy:left")


def test_a_file_with_a_colon_in_its_name(tmp_path):
    path = tmp_path / "12:30.jsonl"
    path.write_bytes(b'{"t":1.0}\n')
    assert [observation.t for observation in igrip.open_source(path)] == [1.0]


def test_further_fields_of_an_intention(tmp_path):
    intention = Intention(t=1.0, hand="right", status="idle")
    lines = {}
    for name in ("a.jsonl", "a.mcap"):
        with open_writer(tmp_path / name) as file:
            file.write(intention, recording="x")
    lines["a.jsonl"] = (tmp_path / "a.jsonl").read_bytes().strip()
    [record] = McapReader(tmp_path / "a.mcap").records(("/intentions",))
    lines["a.mcap"] = record.data
    assert lines["a.jsonl"] == lines["a.mcap"]
    assert json.loads(lines["a.mcap"]) == intention.to_dict() | {"recording": "x"}


def test_a_dataset_of_mcap_is_the_dataset_of_jsonl(small_dataset):
    """Its trials are found, and judged the same to the last bit."""
    catalog = igrip.load_objects(*small_dataset.objects)
    config = igrip.Config(targets="paper")

    def judged():
        dataset = Dataset.open(small_dataset.path)
        runs = [run_trial(dataset, trial, catalog, [config]) for trial in dataset.trials]
        return [replay_run(run, keep_intentions=True) for run in runs]

    before = judged()
    for trial in small_dataset.trials:
        path = small_dataset.recording(trial)
        with McapWriter(path.with_suffix(".mcap")) as file:
            for observation in JsonlReader(path):
                file.write(observation)
        path.unlink()
    after = judged()
    assert [done.intentions for done in after] == [done.intentions for done in before]
    assert repr(after) == repr(before)
    assert before[0].rows[0]["problem"] is None


@pytest.mark.parametrize("make", [McapReader, McapWriter])
def test_a_missing_package(tmp_path, monkeypatch, make):
    monkeypatch.setitem(sys.modules, "mcap.records", None)
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(MissingExtraError, match=r"\(extra mcap\): pip install 'mcap"):
        make(tmp_path / "a.mcap")
    assert not (tmp_path / "a.mcap").exists()


def test_lines_on_a_full_disk(tmp_path):
    writer = JsonlWriter(tmp_path / "a.jsonl")
    real = writer._file._file

    class Full:
        def write(self, data):
            raise OSError(errno.ENOSPC, "No space left on device")

    writer._file._file = Full()
    with pytest.raises(RecordingError, match="No space left on device; what was recorded"):
        writer.write(Observation(t=1.0))
    real.close()
