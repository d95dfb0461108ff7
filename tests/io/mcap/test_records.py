"""Damaged MCAP recordings: a prefix or a RecordingError, and nothing else."""

import gc
import logging
import os
import struct
import tracemalloc

import numpy as np
import pytest

from igrip import Observation
from igrip.errors import RecordingError
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.records import MAGIC, MAX_BYTES
from igrip.io.mcap.writer import McapWriter
from rgbd_frames import SMALL, frame

TINY = SMALL._replace(width=8, height=6)


@pytest.fixture
def whole(tmp_path):
    """A small file of two chunks, its messages and its frames."""
    messages = [Observation(t=k / 30, hands={"right": {"position": [0, 0, k]}}) for k in range(6)]
    path = tmp_path / "whole.mcap"
    with McapWriter(path) as writer:
        for k, message in enumerate(messages):
            writer._flushed = -1.0 if k == 3 else writer._flushed
            writer.write(message)
            if k % 2:
                writer.write_frame(frame(k, intrinsics=TINY))
    return path.read_bytes(), messages, 3


def read(path, data=None, pictures=True):
    """Return messages, frames and whether the file was said to be damaged."""
    if data is not None:
        path.write_bytes(data)
    reader, told = McapReader(path), False
    messages, frames = [], []
    try:
        messages.extend(reader)
    except RecordingError as error:
        told = str(path) in str(error)
    else:
        told = reader.cut is not None
    try:
        if pictures:
            frames.extend(reader.frames())
    except RecordingError as error:
        told = told and str(path) in str(error)
    return messages, frames, told


def test_cut_at_every_byte(tmp_path, whole, caplog):
    data, messages, _ = whole
    caplog.set_level(logging.ERROR, "igrip")  # thousands of warnings are slow to keep
    counts, pictures = [], []
    path = tmp_path / "cut.mcap"
    path.write_bytes(data)
    [index] = struct.unpack("<Q", data[-28:-20])  # where the summary begins, by the footer
    for end in range(len(data) - 1, -1, -1):
        if end > index and end % 11:
            continue  # igrip does not read the summary
        os.truncate(path, end)
        seen, frames, told = read(path, pictures=end % 7 == 0)
        assert seen == messages[: len(seen)]
        assert told or len(seen) == len(messages)
        counts.append(len(seen))
        pictures += [len(frames)] if end % 7 == 0 else []
    assert counts == sorted(counts, reverse=True)
    assert pictures == sorted(pictures, reverse=True)
    assert {counts[0], counts[-1], pictures[0], pictures[-1]} == {6, 0, 3}
    assert {4, 6} <= set(counts) <= {0, 3, 4, 6}


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_flipped_bytes(tmp_path, whole, caplog, seed):
    data, messages, _ = whole
    caplog.set_level(logging.ERROR, "igrip")
    rng = np.random.default_rng(seed)
    for k in range(1500 if seed == 0 else 30_000):
        broken = bytearray(data)
        for at in rng.integers(0, len(data), rng.integers(1, 4)):
            broken[at] ^= rng.integers(1, 256)
        seen, _, told = read(tmp_path / "broken.mcap", bytes(broken), pictures=k % 4 == 0)
        assert seen == messages[: len(seen)] or told


def test_noise_behind_the_beginning(tmp_path):
    rng = np.random.default_rng(0)
    for _ in range(300):
        noise = rng.integers(0, 256, rng.integers(0, 200), dtype=np.uint8).tobytes()
        assert read(tmp_path / "noise.mcap", MAGIC + noise)[0] == []


def test_zeros_behind_a_cut(tmp_path, whole):
    data, messages, _ = whole
    reader = tmp_path / "zeros.mcap"
    half = data.index(b"zstd", data.index(b"zstd") + 4) - 40  # somewhere in the second chunk's head
    for end in (len(data) // 3, half):
        seen, _, told = read(reader, data[:end] + bytes(5000))
        assert told
        assert seen == messages[: len(seen)]


def test_an_empty_file(tmp_path):
    assert read(tmp_path / "x.mcap", b"") == ([], [], True)


def test_a_small_chunk_that_claims_to_be_huge(tmp_path):
    import zstandard

    packed = zstandard.compress(bytes(MAX_BYTES + 1))
    body = struct.pack("<QQQII", 0, 0, 100, 0, 4) + b"zstd" + struct.pack("<Q", len(packed))
    record = struct.pack("<BQ", 6, len(body) + len(packed)) + body + packed
    (tmp_path / "x.mcap").write_bytes(MAGIC + record)
    gc.collect()
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match="a chunk of"):
            list(McapReader(tmp_path / "x.mcap"))
        assert tracemalloc.get_traced_memory()[1] < 5_000_000
    finally:
        tracemalloc.stop()


def test_a_gap_in_the_middle_is_noticed(tmp_path, whole):
    data, _, _ = whole
    first = data.index(b"\x06", len(MAGIC) + 30)
    while data[first] != 6 or struct.unpack_from("<Q", data, first + 1)[0] > len(data):
        first = data.index(b"\x06", first + 1)
    broken = bytearray(data)
    broken[first] = 0x7F  # the first chunk becomes a record of the future, which readers skip
    seen, _, told = read(tmp_path / "gap.mcap", bytes(broken))
    assert told
    assert seen == []
