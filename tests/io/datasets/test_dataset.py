"""Datasets as files: what is written is read back, and what is wrong is named."""

import json
from pathlib import Path

import pytest

from igrip import Observation
from igrip.errors import DatasetError, RecordingError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter


def test_round_trip(tmp_path: Path) -> None:
    writer = DatasetWriter(tmp_path / "d", "Name", "MIT", "hand-made", objects=["ycb"])
    trials = [
        Trial("a", "p1", "1", hand="left", target="soup", onset_s=0.5, end_s=1.25),
        Trial("b", "p2", target="none", extra={"distance": "far"}),
    ]
    for trial in trials:
        writer.add(trial, [Observation(t=0.0), Observation(t=0.1)])
    writer.close({"p1": {"age": "44"}})
    dataset = Dataset.open(tmp_path / "d")
    assert list(dataset.trials) == trials
    assert (dataset.name, dataset.objects) == ("Name", ("ycb",))
    assert dataset.recording(trials[0]).read_bytes().count(b"\n") == 2
    people = (tmp_path / "d" / "participants.tsv").read_text().splitlines()
    assert people == ["participant\tage", "p1\t44", "p2\t"]


def test_columns_are_those_of_the_contract(tmp_path: Path) -> None:
    writer = DatasetWriter(tmp_path / "d", "Name", "MIT", "hand-made")
    writer.add(Trial("a"), [])
    writer.close()
    header = (tmp_path / "d" / "trials.tsv").read_text().splitlines()[0]
    assert header.split("\t") == [
        "recording",
        "participant",
        "trial",
        "camera",
        "camera_side",
        "hand",
        "target",
        "grip",
        "movement",
        "onset_s",
        "end_s",
        "performed",
        "repeat_of",
    ]
    description = json.loads((tmp_path / "d" / "dataset.json").read_text())
    assert description == {
        "format": "igrip-dataset/1", "name": "Name", "license": "MIT", "source": "hand-made",
    }  # fmt: skip


def test_an_existing_folder_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("precious")
    with pytest.raises(DatasetError, match="exists already"):
        DatasetWriter(tmp_path, "n", "l", "s")


@pytest.mark.parametrize(
    ("description", "trials", "problem"),
    [
        (None, "recording\n", "no dataset.json"),
        ("{", "recording\n", "dataset.json"),
        ('{"format": "other/1"}', "recording\n", "must be 'igrip-dataset/1'"),
        ('{"format": "igrip-dataset/1", "objects": "ycb"}', "recording\n", "list of strings"),
        ('{"format": "igrip-dataset/1"}', "name\nx\n", "no column 'recording'"),
        ('{"format": "igrip-dataset/1"}', "recording\tonset_s\na\tsoon\n", "line 2, onset_s"),
        (
            '{"format": "igrip-dataset/1"}',
            "recording\tend_s\na\tnan\n",
            "line 2, end_s: 'nan' is no",
        ),
        (
            '{"format": "igrip-dataset/1"}',
            "recording\tonset_s\tend_s\na\t2\t1\n",
            "ends before it begins",
        ),
        ('{"format": "igrip-dataset/1"}', "recording\thand\n\tleft\n", "line 2: recording is emp"),
        ('{"format": "igrip-dataset/1"}', "recording\na\tb\tc\n", "more fields than the header"),
    ],
)
def test_what_is_wrong_is_named(
    tmp_path: Path, description: str | None, trials: str, problem: str
) -> None:
    if description is not None:
        (tmp_path / "dataset.json").write_text(description)
    (tmp_path / "trials.tsv").write_text(trials)
    with pytest.raises(DatasetError, match=problem):
        Dataset.open(tmp_path)


@pytest.mark.parametrize("name", ["../evil", "a/b", "", ".hidden", "a\\b", "..", "nul\0"])
def test_recordings_stay_in_their_folder(tmp_path: Path, name: str) -> None:
    writer = DatasetWriter(tmp_path / "d", "n", "l", "s")
    with writer, pytest.raises(DatasetError, match="cannot be named"):
        writer.add(Trial(name), [])
    words = "no recording 'a/b'" if name in ("a/b", "a\\b") else "cannot be named"
    with pytest.raises((DatasetError, RecordingError), match=words):
        Dataset(tmp_path, {}, ()).recording(Trial(name))
    assert list(tmp_path.iterdir()) == []


def test_a_dataset_is_there_as_a_whole_or_not_at_all(tmp_path: Path) -> None:
    def interrupted() -> None:
        with DatasetWriter(tmp_path / "d", "n", "l", "s") as writer:
            writer.add(Trial("a"), [Observation(t=0.0)])
            assert not (tmp_path / "d").exists()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_names_are_given_once(tmp_path: Path) -> None:
    with DatasetWriter(tmp_path / "d", "n", "l", "s") as writer:
        writer.add(Trial("a"), [])
        with pytest.raises(DatasetError, match="two recordings are named 'a'"):
            writer.add(Trial("a"), [])


def test_a_byte_order_mark_is_no_column(tmp_path: Path) -> None:
    (tmp_path / "dataset.json").write_text('\ufeff{"format": "igrip-dataset/1"}')
    (tmp_path / "trials.tsv").write_text("\ufeffrecording\thand\na\tleft\n")
    assert Dataset.open(tmp_path).trials == (Trial("a", hand="left"),)
