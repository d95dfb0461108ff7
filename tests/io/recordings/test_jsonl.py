"""Recordings as lines of JSON: written, read, cut off, damaged."""

from __future__ import annotations

import gc
import gzip
import json
import logging

import numpy as np
import pytest

import igrip
from igrip import Intention, Observation
from igrip.errors import RecordingError
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from support import hand, lines, message, pose, run, scene_of_shapes


@pytest.fixture
def scene():
    """Observations of a scene."""
    return [Observation(**plain) for plain in scene_of_shapes(np.random.default_rng(1))]


def write(path, observations):
    with JsonlWriter(path) as writer:
        for observation in observations:
            writer.write(observation)
    return path


def test_round_trip(tmp_path, scene):
    path = write(tmp_path / "scene.jsonl", scene)
    reader = JsonlReader(path)
    assert list(reader) == scene
    assert list(reader) == scene  # it may be iterated again
    assert reader.cut is None
    assert path.read_bytes().count(b"\n") == len(scene)
    assert list(JsonlReader(str(path))) == scene


@pytest.mark.parametrize("name", ["scene.jsonl.gz", "SCENE.JSONL.GZ", "scene.jsonl"])
def test_compressed_recordings_are_read(tmp_path, scene, name):
    whole = write(tmp_path / "whole.jsonl", scene).read_bytes()
    (tmp_path / name).write_bytes(gzip.compress(whole))
    assert list(igrip.open_source(tmp_path / name)) == scene


@pytest.mark.parametrize("damage", ["cut", "changed"])
def test_a_damaged_compressed_recording_yields_what_is_before_the_damage(tmp_path, scene, damage):
    packed = bytearray(gzip.compress(write(tmp_path / "whole.jsonl", scene).read_bytes()))
    if damage == "cut":
        del packed[-len(packed) // 4 :]
    else:
        packed[-8] ^= 0xFF  # the checksum
    path = tmp_path / "x.jsonl.gz"
    path.write_bytes(packed)
    reader = JsonlReader(path)
    found = list(reader)
    assert len(found) > len(scene) // 2
    assert found == scene[: len(found)]
    assert "after line" in reader.cut


@pytest.mark.parametrize("end", ["\r", "\r\n", "\n"])
def test_line_ends_of_every_system(tmp_path, scene, end):
    text = "".join(f"{observation.to_json().decode()}{end}" for observation in scene)
    (tmp_path / "x.jsonl").write_bytes(text.encode())
    reader = JsonlReader(tmp_path / "x.jsonl")
    assert list(reader) == scene
    assert reader.cut is None


def test_writing_what_was_read_gives_the_same_bytes(tmp_path, scene):
    path = write(tmp_path / "scene.jsonl", scene)
    again = write(tmp_path / "again.jsonl", JsonlReader(path))
    assert again.read_bytes() == path.read_bytes()


def test_intentions_can_be_written_too(tmp_path, scene, shapes):
    told = run([json.loads(o.to_json()) for o in scene], shapes)
    path = write(tmp_path / "told.jsonl", told)
    assert lines(map(Intention.from_json, path.read_bytes().splitlines())) == lines(told)


def test_each_message_is_on_disk_when_write_returns(tmp_path, scene):
    path = tmp_path / "scene.jsonl"
    with JsonlWriter(path) as writer:
        for count, observation in enumerate(scene[:5], start=1):
            writer.write(observation)
            assert len(list(JsonlReader(path))) == count


def test_an_existing_file_is_replaced(tmp_path, scene):
    path = write(tmp_path / "scene.jsonl", scene)
    write(path, scene[:2])
    assert list(JsonlReader(path)) == scene[:2]


def test_cut_at_every_byte_of_the_last_line(tmp_path, caplog):
    observations = [
        Observation(**message(1.0 + k, {"右手": hand((0.1, 0.2, 0.3 + k))},
                              {"mug": pose((0, 0, 0), model="mug ☕")}))
        for k in range(3)
    ]  # fmt: skip
    path = write(tmp_path / "scene.jsonl", observations)
    whole = path.read_bytes()
    start = whole.rindex(b"\n", 0, -1) + 1
    for end in range(start, len(whole) + 1):
        path.write_bytes(whole[:end])
        caplog.clear()
        reader = JsonlReader(path)
        with caplog.at_level(logging.WARNING, logger="igrip"):
            seen = list(reader)
        complete = end >= len(whole) - 1  # all but the line break
        assert seen == observations[: 3 if complete else 2]
        if complete or end == start:
            assert reader.cut is None
            assert not caplog.records
        else:
            assert "line 3" in reader.cut
            assert str(path) in reader.cut
            [record] = caplog.records
            assert record.levelno == logging.WARNING
            assert record.getMessage() == reader.cut


@pytest.mark.parametrize("zeros", [1, 4096])
def test_cut_with_zeros_behind(tmp_path, scene, zeros):
    """What a file system leaves of a block that was promised and not written."""
    path = write(tmp_path / "scene.jsonl", scene)
    whole = path.read_bytes()
    path.write_bytes(whole + b"\0" * zeros)
    assert list(JsonlReader(path)) == scene
    path.write_bytes(whole[:-10] + b"\0" * zeros)
    reader = JsonlReader(path)
    assert list(reader) == scene[:-1]
    assert reader.cut is not None


def test_cut_is_about_the_last_iteration(tmp_path, scene):
    path = write(tmp_path / "scene.jsonl", scene)
    whole = path.read_bytes()
    path.write_bytes(whole[:-10])
    reader = JsonlReader(path)
    list(reader)
    assert reader.cut is not None
    path.write_bytes(whole)
    assert list(reader) == scene
    assert reader.cut is None


@pytest.mark.parametrize(
    ("line", "what", "where"),
    [
        (b'{"t":', "skipped", "messages message: is not JSON"),
        (b"nonsense", "skipped", "messages message: is not JSON"),
        (b"[1, 2]", "skipped", "messages message: must be an object"),
        (b'{"hands":{}}', "skipped", "messages t: must be a number"),
        (b'{"t":5.0,"schema":"igrip/2"}', "skipped", "messages schema: must be"),
        (b'{"t":1.0}', "skipped", "t steps back by 2 s"),
        (b'{"t":5.0,"hands":{"right":{"position":[0,null,0]}}}', "not seen",
         "hands.right position[1]: must be a number"),
        (b'{"t":5.0,"hands":{"right":{"position":[0,NaN,0]}}}', "not seen",
         "hands.right position[1]: must be finite"),
        (b'{"t":5.0,"objects":{"mug":{"position":[0,0,0]}}}', "not seen",
         "objects.mug orientation: is missing"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("last", [False, True])
def test_a_malformed_line_costs_itself_and_is_named(tmp_path, line, what, where, last):
    path = tmp_path / "scene.jsonl"
    path.write_bytes(b'{"t":3.0}\n\n' + line + b"\n" + (b"" if last else b'{"t":9.0}\n'))
    reader = JsonlReader(path)
    seen = list(reader)
    assert seen[0] == Observation(t=3.0)
    assert len(seen) == 1 + (what == "not seen") + (not last)
    assert last or seen[-1] == Observation(t=9.0)
    [row] = [row for row in reader.defects.report() if row["what"] != "gap"]
    assert (row["what"], row["first"], row["count"]) == (what, "line 3", 1)
    assert f"{row['path']} {row['problem']}".startswith(where)


def test_a_file_without_one_good_line_names_the_first(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_bytes(b'\n{"x":1.0}\n{"t":"x"}\n')
    with pytest.raises(RecordingError, match="line 2: t: "):
        list(JsonlReader(path))


def test_a_whole_last_line_that_is_wrong_is_no_cut(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_bytes(b'{"t":1.0}\n{"t":"x"}')
    reader = JsonlReader(path)
    assert list(reader) == [Observation(t=1.0)]
    assert reader.cut is None
    assert "line 2" in next(iter(reader.defects.lines()))


def test_blank_lines_and_windows_line_breaks(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_bytes(b'\n\r\n  {"t":1.0}\r\n\t\n{"t":1.0}  \r\n\n{"t":2.0}')
    assert [observation.t for observation in JsonlReader(path)] == [1.0, 1.0, 2.0]


def test_an_empty_file(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_bytes(b"")
    reader = JsonlReader(path)
    assert list(reader) == []
    assert reader.cut is None


@pytest.mark.parametrize("kind", ["missing", "folder"])
def test_files_that_cannot_be_opened(tmp_path, kind):
    path = tmp_path if kind == "folder" else tmp_path / "nowhere" / "scene.jsonl"
    for make in (JsonlReader, JsonlWriter):
        with pytest.raises(RecordingError) as raised:
            make(path)
        assert str(path) in str(raised.value)


def test_an_iteration_that_is_given_up_closes_the_file(tmp_path, monkeypatch):
    ticks = [Observation(t=k / 30.0) for k in range(500)]  # more than are read ahead
    path = write(tmp_path / "scene.jsonl", ticks)
    reader, opened = JsonlReader(path), []
    open_file = reader.open
    monkeypatch.setattr(reader, "open", lambda: opened.append(open_file()) or opened[-1])
    iterator = iter(reader)
    next(iterator)
    assert [file.closed for file in opened] == [False]
    del iterator
    gc.collect()
    assert [file.closed for file in opened] == [True]


def test_open_source_reads_it(tmp_path, scene):
    path = write(tmp_path / "scene.jsonl", scene)
    for name in (path, str(path)):
        assert list(igrip.open_source(name)) == scene
    upper = write(tmp_path / "SCENE.JSONL", scene)
    assert list(igrip.open_source(upper)) == scene
