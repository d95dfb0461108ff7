"""Intentions read back, and their table, against the messages themselves."""

from __future__ import annotations

import builtins
import csv
import json
import math

import pandas as pd
import pytest

import igrip
from igrip import Intention, read_intentions
from igrip.errors import MissingExtraError, RecordingError
from igrip.intention import Commitment
from igrip.io.intention_files import ENDINGS, open_intention_writer
from igrip.io.intention_table import columns
from igrip.io.mcap.writer import McapWriter
from igrip.io.recordings.jsonl import JsonlWriter

FULL = Intention(
    t=1.5, hand="right", status="reaching", target="mug", target_model="box:0.1x0.1x0.1",
    confidence=0.7, grip="pinch", grip_probability={"palmar": 0.2, "pinch": 0.8},
    time_to_contact=0.4, time_to_contact_interval=(0.3, 0.6), contact=(0.1, 0.2, 0.3),
    probability={"mug": 0.7, "can": 0.1, "none": 0.2}, familiarity=0.9,
    scores={"mug": {"distance": 0.6, "global": 0.7}, "can": {"distance": 0.4, "global": 0.1}},
    commitment=Commitment(target="mug", grip="pinch", since=1.4, valid_until=1.65),
)  # fmt: skip
LOST = Intention(t=1.6, hand="left", status="lost", reason="not detected yet")
CUE = Intention(t=1.7, hand="left", status="reaching", target="can",
                scores={"can": {"distance": 0.9, "global": 0.9}})  # fmt: skip
ALL = [FULL, LOST, CUE]


def test_a_row_for_each_candidate_and_one_where_there_is_none():
    frame = read_intentions(ALL).to_frame()
    assert list(frame) == list(columns())
    assert frame["candidate"].tolist() == ["mug", "can", "none", pd.NA, "can"]
    assert frame["t"].tolist() == [1.5, 1.5, 1.5, 1.6, 1.7]
    mug = frame.iloc[0]
    for name in ("hand", "status", "target", "confidence", "grip", "time_to_contact"):
        assert mug[name] == getattr(FULL, name)
    assert (mug["time_to_contact_low"], mug["time_to_contact_high"]) == (0.3, 0.6)
    assert (mug["contact_x"], mug["contact_y"], mug["contact_z"]) == FULL.contact
    assert mug["grip_probability"] == 0.8  # that of the pinch
    assert (mug["commitment_since"], mug["commitment_valid_until"]) == (1.4, 1.65)
    assert (mug["probability"], mug["score_global"], mug["score_distance"]) == (0.7, 0.7, 0.6)
    assert frame["probability"][:3].sum() == pytest.approx(1.0)


def test_what_is_unknown_is_missing_and_never_zero():
    frame = read_intentions(ALL).to_frame()
    assert math.isnan(frame["score_distance"][2])  # none has no scores
    assert frame.loc[3, ["target", "probability", "confidence", "commitment_since"]].isna().all()
    assert frame.loc[4, ["probability", "time_to_contact_low", "contact_x"]].isna().all()
    assert frame["recording"].isna().all()


def test_a_row_for_each_intention():
    frame = read_intentions(ALL).to_frame(per="intention")
    assert len(frame) == 3
    assert not {"candidate", "probability", "score_global"} & set(frame)
    assert frame["hand"].tolist() == ["right", "left", "left"]


def test_the_columns_are_the_same_without_any_intention():
    empty = read_intentions([]).to_frame()
    full = read_intentions(ALL).to_frame()
    assert empty.dtypes.tolist() == full.dtypes.tolist()


@pytest.mark.parametrize("writer", [JsonlWriter, McapWriter])
def test_what_was_written_is_read_back(tmp_path, writer):
    path = tmp_path / f"i.{'jsonl' if writer is JsonlWriter else 'mcap'}"
    with writer(path) as file:
        for intention in ALL:
            file.write(intention, recording="r1", targets="bayes")
    again = read_intentions(path)
    assert list(again) == ALL
    assert set(again.to_frame()["recording"]) == {"r1"}
    assert again[1:].origins == [{"recording": "r1", "targets": "bayes"}] * 2


def test_lines_dictionaries_and_messages_are_the_same():
    assert list(read_intentions(i.to_json() for i in ALL)) == ALL
    assert list(read_intentions([i.to_dict() for i in ALL])) == ALL


def test_a_last_line_that_was_cut_off_is_left_out(tmp_path):
    path = tmp_path / "i.jsonl"
    path.write_bytes(FULL.to_json() + b"\n\n" + LOST.to_json()[:-4])
    assert list(read_intentions(path)) == [FULL]
    path.write_bytes(FULL.to_json() + b"\n" + LOST.to_json())  # whole, without a line end
    assert list(read_intentions(path)) == [FULL, LOST]


def test_what_is_no_intention_is_named_with_its_line(tmp_path):
    path = tmp_path / "i.jsonl"
    path.write_text('\n{"t": 0, "hands": {}}\n')
    with pytest.raises(RecordingError, match=r"i\.jsonl, line 2: is an observation.*igrip replay"):
        read_intentions(path)
    path.write_text("nonsense\n")
    with pytest.raises(RecordingError, match="line 1: is no intention"):
        read_intentions(path)
    with pytest.raises(RecordingError, match="intention 2: is no intention"):
        read_intentions([FULL, {"t": 1}])
    with pytest.raises(RecordingError, match=r"none\.jsonl"):
        read_intentions(tmp_path / "none.jsonl")
    with pytest.raises(RecordingError, match=r"pandas\.read_parquet"):
        read_intentions("x.parquet")
    with pytest.raises(RecordingError, match=r"\.jsonl or \.mcap"):
        read_intentions("x.txt")


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_the_table_in_a_file_is_that_of_to_frame(tmp_path, ending, monkeypatch):
    monkeypatch.setattr("igrip.io.intention_files.GROUP", 4)  # several groups
    path = tmp_path / f"i{ending}"
    origin = {"recording": "r1", "targets": "bayes"}
    with open_intention_writer(path, **origin) as file:
        for intention in ALL * 3:
            file.write(intention)
    expected = igrip.Intentions(ALL * 3, [origin] * 9).to_frame()
    read = pd.read_csv(path) if ending == ".csv" else pd.read_parquet(path)
    pd.testing.assert_frame_equal(read.astype(expected.dtypes), expected)


def test_the_rows_of_a_csv_without_any_other_package(tmp_path):
    with open_intention_writer(tmp_path / "i.csv") as file:
        file.write(FULL, recording="a,b")
    with (tmp_path / "i.csv").open(newline="") as text:
        rows = list(csv.DictReader(text))
    assert [row["candidate"] for row in rows] == ["mug", "can", "none"]
    assert {row["recording"] for row in rows} == {"a,b"}
    assert rows[2]["score_distance"] == ""


def test_a_recording_keeps_every_field(tmp_path):
    with open_intention_writer(tmp_path / "i.jsonl") as file:
        file.write(FULL)
    assert json.loads((tmp_path / "i.jsonl").read_text()) == json.loads(FULL.to_json())


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_folder_that_is_missing(tmp_path, ending):
    with pytest.raises(RecordingError, match="No such file"):
        open_intention_writer(tmp_path / "gone" / f"i{ending}")


@pytest.mark.parametrize("package", ["pandas", "pyarrow"])
def test_the_error_without_the_packages_names_the_extra(tmp_path, monkeypatch, package):
    real = builtins.__import__

    def without(name, *arguments, **options):
        if name.split(".")[0] == package:
            raise ImportError(name)
        return real(name, *arguments, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    use = {"pandas": read_intentions(ALL).to_frame,
           "pyarrow": lambda: open_intention_writer(tmp_path / "i.parquet")}  # fmt: skip
    with pytest.raises(MissingExtraError, match=r"\(extra tables\): pip install 'pandas"):
        use[package]()
