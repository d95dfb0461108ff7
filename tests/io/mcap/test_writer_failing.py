"""When the disk, or the user, ends a recording: what is there stays readable."""

import errno
import time

import pytest

from igrip import Observation
from igrip.errors import RecordingError
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter


def test_a_full_disk_leaves_a_readable_file(tmp_path):
    """The writes of a disk that takes so many bytes and then no more."""
    path = tmp_path / "x.mcap"
    writer = McapWriter(path)
    room = 20_000
    write_file = writer._sink._file.write

    class File:
        def __getattr__(self, name):
            return getattr(real, name)

        def write(self, data):
            if real.tell() >= room:
                raise OSError(errno.ENOSPC, "No space left on device")
            return write_file(bytes(data)[: room - real.tell()])  # what fits

    real, writer._sink._file = writer._sink._file, File()
    written = -1

    def fill():
        nonlocal written
        for written in range(10_000):
            writer.write(Observation(t=written / 100))
            if written % 20 == 0:
                writer._flushed = -1.0  # as if half a second had passed

    with pytest.raises(RecordingError, match="No space left on device; what was recorded"):
        fill()
    with pytest.raises(RecordingError, match="No space left"):
        writer.write(Observation(t=1e6))
    writer.close()  # told already
    reader = McapReader(path)
    times = [o.t for o in reader]
    assert times == [k / 100 for k in range(len(times))]
    assert written - len(times) <= 41
    assert len(times) > 50
    assert "cut off" in reader.cut
    assert path.stat().st_size <= room


def test_close_tells_a_failure_nobody_was_told(tmp_path):
    writer = McapWriter(tmp_path / "x.mcap")
    writer.write(Observation(t=1.0))

    def fail():
        raise OSError(errno.EIO, "Input/output error")

    writer._sink.sync = fail
    with pytest.raises(RecordingError, match="Input/output error"):
        writer.close()
    writer.close()


def test_writing_to_a_closed_file(tmp_path):
    writer = McapWriter(tmp_path / "x.mcap")
    writer.write(Observation(t=1.0))
    writer.close()
    writer.close()
    with pytest.raises(RecordingError, match="is closed"):
        writer.write(Observation(t=2.0))
    assert list(McapReader(tmp_path / "x.mcap")) == [Observation(t=1.0)]


def test_an_idle_file_is_flushed_too(tmp_path):
    writer = McapWriter(tmp_path / "x.mcap")
    writer.write(Observation(t=1.0))
    deadline = time.monotonic() + 60  # by the thread, some time after the last message
    while not list(McapReader(tmp_path / "x.mcap")) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert list(McapReader(tmp_path / "x.mcap")) == [Observation(t=1.0)]
    writer.close()


def test_ctrl_c_in_the_middle_of_a_record(tmp_path, monkeypatch):
    path = tmp_path / "x.mcap"

    def interrupted(data):
        writer._sink._file.write(data[: len(data) // 2])
        raise KeyboardInterrupt

    writer = McapWriter(path)
    writer._flushed = -1.0
    writer.write(Observation(t=1.0))
    monkeypatch.setattr(writer._sink, "write", interrupted)
    writer._flushed = -1.0
    with pytest.raises(KeyboardInterrupt):
        writer.write(Observation(t=2.0))
    with pytest.raises(RecordingError, match="interrupted"):
        writer.close()
    reader = McapReader(path)
    assert list(reader) == [Observation(t=1.0)]
    assert reader.cut is not None
