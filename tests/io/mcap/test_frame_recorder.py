"""Recording frames as they come: nothing queues up, what is lost is counted."""

import threading

import pytest

from igrip.errors import RecordingError
from igrip.io.mcap.frame_recorder import MAX_WAITING, FrameRecorder
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter
from rgbd_frames import frame


def test_all_are_written_if_there_is_time(tmp_path):
    with McapWriter(tmp_path / "x.mcap") as writer:
        recorder = FrameRecorder(writer)
        for k in range(MAX_WAITING):
            assert recorder.add(frame(k, camera="a"))
            assert recorder.add(frame(k, camera="b"))
        recorder.close()
    seen = list(McapReader(tmp_path / "x.mcap").frames())
    for name in "ab":
        times = [one.t for one in seen if one.camera == name]
        assert times == pytest.approx([frame(k).t for k in range(MAX_WAITING)])
    assert recorder.dropped == 0


def test_what_comes_too_fast_is_dropped_and_counted(tmp_path, monkeypatch):
    with McapWriter(tmp_path / "x.mcap") as writer:
        go = threading.Event()
        write = writer.write_frame
        monkeypatch.setattr(writer, "write_frame", lambda one: (go.wait(), write(one)))
        recorder = FrameRecorder(writer)
        for k in range(100):
            recorder.add(frame(k))
        go.set()
        recorder.close()
    kept = 100 - recorder.dropped
    assert kept in (MAX_WAITING, MAX_WAITING + 1)  # and the one that is being written
    assert recorder.received == 100
    assert len(list(McapReader(tmp_path / "x.mcap").frames())) == kept


def test_an_error_of_the_disk_is_raised(tmp_path, monkeypatch):
    with McapWriter(tmp_path / "x.mcap") as writer:

        def fail(one):
            raise RecordingError("x.mcap: No space left on device")

        monkeypatch.setattr(writer, "write_frame", fail)
        recorder = FrameRecorder(writer)
        recorder.add(frame())
        with pytest.raises(RecordingError, match="No space left"):
            recorder.close()
        with pytest.raises(RecordingError, match="No space left"):
            recorder.add(frame(1))
