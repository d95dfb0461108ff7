"""Datasets at addresses: fetched when they are read, again when they change, and no further."""

import json
import pickle
import shutil
from pathlib import Path

import pytest

from igrip import Config
from igrip.errors import DatasetError, RecordingError, StorageError
from igrip.io.datasets.dataset import Dataset
from igrip.io.datasets.shared import SharedFolder, address_of, open_dataset
from igrip.io.datasets.trial import Trial
from igrip.lab import parallel
from igrip.lab.evaluation.evaluation import Evaluation
from igrip.lab.parallel import Workers

fsspec = pytest.importorskip("fsspec", reason="the extra 'cluster' is not installed")


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    monkeypatch.setattr("igrip.io.datasets.shared.cache_directory", lambda: folder)
    return folder


@pytest.fixture
def stored(small_dataset):
    """The small dataset in storage that is no folder of any computer."""
    system = fsspec.filesystem("memory")
    system.put(str(small_dataset.path), "/lab/small", recursive=True)
    yield "memory://lab/small"
    system.rm("/lab", recursive=True)


@pytest.mark.parametrize(("path", "address"), [
    ("s3://bucket/cohort", "s3://bucket/cohort"), ("s3:/bucket/cohort/", "s3://bucket/cohort"),
    ("gs://b", "gs://b"), ("file:///data/x", "file:///data/x"), ("file:/data/x", "file:///data/x"),
    (Path("file:///data/x"), "file:///data/x"), (Path("s3://b/c"), "s3://b/c"),
    ("C:/data/cohort", None), ("/data/cohort", None), ("cohort", None),
    ("a:b", None),
])  # fmt: skip
def test_what_is_an_address(path, address):
    assert address_of(path) == address


def test_recordings_are_fetched_when_they_are_read(small_dataset, stored, cache):
    opened = open_dataset(stored)
    assert opened.trials == small_dataset.trials
    assert opened.objects == small_dataset.objects
    assert not list(cache.rglob("recordings"))
    first = opened.trials[0]
    ours = [one.to_dict() for one in opened.observations(first)]
    assert ours == [one.to_dict() for one in small_dataset.observations(first)]
    assert len([path for path in cache.rglob("recordings/*") if path.name[0] != "."]) == 1


def test_a_recording_that_changed_is_fetched_again(stored):
    opened = open_dataset(stored)
    first = opened.trials[0]
    before, stamp = opened.recording(first).read_bytes(), opened.stamp(first)
    assert opened.stamp(first) == stamp
    fsspec.filesystem("memory").pipe(f"/lab/small/recordings/{first.recording}.jsonl", b"{}\n")
    assert opened.stamp(first) != stamp
    assert opened.recording(first).read_bytes() == b"{}\n" != before


def test_what_is_not_there_is_named(stored):
    with pytest.raises(DatasetError, match=r"dataset\.json"):
        open_dataset("memory://lab/nothing")
    with pytest.raises(DatasetError, match="nosuchprotocol"):
        open_dataset("nosuchprotocol://x")
    gone = Trial("gone", "p", "1", hand="right", target="mug")
    opened = open_dataset(stored)
    assert opened.stamp(gone) is None
    with pytest.raises(RecordingError, match="no 'gone'"):
        opened.recording(gone)


def test_nothing_is_written_outside_of_the_copy(stored, cache):
    text = json.dumps(json.loads((open_dataset(stored).path / "dataset.json").read_text())
                      | {"objects": ["../elsewhere", "ycb", "."]})  # fmt: skip
    system = fsspec.filesystem("memory")
    system.pipe("/lab/small/dataset.json", text.encode())
    system.pipe("/lab/elsewhere/secret.stl", b"x")
    open_dataset(stored)
    assert not list(cache.rglob("*.stl"))
    with pytest.raises(DatasetError, match="leads out"):
        SharedFolder(stored).fetch("../elsewhere/secret.stl")


def test_storage_that_fails_ends_the_work_and_loses_nothing(stored, tmp_path, monkeypatch):
    opened = open_dataset(stored)
    evaluation = Evaluation(opened, [Config(targets="distance")], tmp_path / "out")
    fetch = SharedFolder.fetch

    def down(self, name):
        if name.startswith("recordings"):
            raise StorageError("network is down")
        return fetch(self, name)

    monkeypatch.setattr(SharedFolder, "fetch", down)
    with pytest.raises(StorageError, match="network is down"):
        list(evaluation.run(opened.trials, Workers()))
    monkeypatch.undo()
    monkeypatch.setattr("igrip.io.datasets.shared.cache_directory", lambda: tmp_path / "other")
    again = open_dataset(stored)
    evaluation = Evaluation(again, [Config(targets="distance")], tmp_path / "out")
    list(evaluation.run(again.trials, Workers()))
    assert all(row["problem"] is None for row in evaluation.rows)


def test_a_dataset_that_was_deleted_is_gone(stored):
    open_dataset(stored)
    fsspec.filesystem("memory").rm("/lab/small/dataset.json")
    with pytest.raises(DatasetError, match="memory://lab/small: is not a dataset"):
        open_dataset(stored)


def test_workers_read_the_same_from_an_address(small_dataset, tmp_path, monkeypatch):
    monkeypatch.setattr(parallel, "MIN_ITEMS", 1)
    shutil.copytree(small_dataset.path, tmp_path / "shared")
    found = []
    for opened in (Dataset.open(tmp_path / "shared"), open_dataset(f"file://{tmp_path}/shared")):
        evaluation = Evaluation(opened, [Config(targets="distance")], tmp_path / str(len(found)))
        list(evaluation.run(opened.trials, Workers(2)))
        found.append([{k: v for k, v in row.items() if k != "stamp"} for row in evaluation.rows])
    assert found[0] == found[1]
    assert all(row["problem"] is None for row in found[0])
    assert pickle.loads(pickle.dumps(opened)) == opened
