"""Recordings damaged at random: no error but their own, and bounded memory."""

from __future__ import annotations

import json
import tracemalloc

import numpy as np
import pytest

from igrip.errors import RecordingError
from igrip.io.frames import DeclaredFrame
from igrip.io.recordings.jsonl import JsonlReader

POSE = {"model": "mug", "position": [0.2, 0.5, 0.1], "orientation": [0.0, 0.0, 0.0, 1.0]}


def reach(count=60, scale=1.0, unit=1.0):
    return [
        {"t": unit * k / 30.0,
         "hands": {"right": {"position": [scale * (0.2 + 0.005 * k), 0.3 * scale, 0.05 * scale]}},
         "objects": {"mug": POSE}}
        for k in range(count)
    ]  # fmt: skip


def write(path, messages):
    path.write_text("".join(json.dumps(message) + "\n" for message in messages))
    return path


def garbled(data, random):
    """Return data with a few bytes changed, removed or doubled."""
    data = bytearray(data)
    for _ in range(int(random.integers(1, 5))):
        at, size = int(random.integers(len(data))), int(random.integers(1, 40))
        kind = int(random.integers(3))
        if kind == 0:
            data[at] = int(random.integers(256))
        elif kind == 1:
            del data[at : at + size]
        else:
            data[at:at] = data[at : at + size]
    return bytes(data)


@pytest.mark.parametrize("count", [300, pytest.param(10_000, marks=pytest.mark.slow)])
def test_damage_costs_a_part_or_is_an_error_that_names_the_file(tmp_path, count):
    whole = write(tmp_path / "whole.jsonl", reach()).read_bytes()
    random = np.random.default_rng(0)
    path, kept = tmp_path / "broken.jsonl", 0
    for _ in range(count):
        path.write_bytes(garbled(whole, random))
        reader = JsonlReader(path)
        try:
            times = [observation.t for observation in reader]
        except RecordingError as error:
            assert str(path) in str(error)  # noqa: PT017
        else:
            assert times == sorted(times)
            kept += len(times)
            # what was doubled may be a message like any other
            assert len(times) >= 60 or len(reader.defects) or reader.cut
    assert kept > 20 * count


def test_memory_is_bounded_whatever_the_lines_hold(tmp_path):
    path = tmp_path / "x.jsonl"
    long = b'{"t": 1.0, "x": "' + b"x" * 5_000_000
    path.write_bytes(b"\n".join([long, b"[" * 1_000_000, b'{"t": 2.0}', long, b'{"t": 3.0}']))
    size = path.stat().st_size
    tracemalloc.start()
    try:
        assert [observation.t for observation in JsonlReader(path)] == [2.0, 3.0]
        assert tracemalloc.get_traced_memory()[1] < size
    finally:
        tracemalloc.stop()


def test_numbers_that_cannot_be_meant_so_are_refused_before_the_first_message(tmp_path):
    path = write(tmp_path / "ms.jsonl", reach(unit=1000.0))
    with pytest.raises(RecordingError, match="are these ms") as raised:
        next(iter(JsonlReader(path)))
    assert "--time-unit ms" in str(raised.value)
    taken = list(JsonlReader(path, DeclaredFrame.declare(time_unit="ms")))
    assert taken[-1].t == pytest.approx(59 / 30.0)


def test_what_is_unusual_is_a_remark(tmp_path):
    lying = POSE | {"orientation": [0.5**0.5, 0.0, 0.0, 0.5**0.5]}
    messages = [message | {"objects": {"mug": lying}} for message in reach()]
    reader = JsonlReader(write(tmp_path / "y.jsonl", messages))
    assert len(list(reader)) == 60
    assert any("up = -y" in remark for remark in reader.remarks)
