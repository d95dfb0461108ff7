"""A recording as a camera: its frames, its pace, its end."""

import threading
import time

import cv2
import numpy as np
import pytest

from igrip.io.mcap.writer import McapWriter
from igrip.perception.cameras import CameraError, open_camera
from rgbd_frames import frame, same


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "a+b.mcap"
    with McapWriter(path, lossless=True) as writer:
        for k in range(6):
            writer.write_frame(frame(k, camera=f"c{k % 2}"))
    return path


def test_as_fast_as_asked_the_times_are_those_of_the_file(recording):
    camera = open_camera(f"replay:{recording}?speed=0")
    seen = list(camera)
    assert all(same(a, frame(k, camera=f"c{k % 2}")) for k, a in enumerate(seen))
    assert all(a.t == b.t for a, b in zip(seen, camera, strict=True))  # again, bit for bit
    camera.close()


def test_at_its_own_pace_the_times_are_now(recording):
    begin = time.monotonic()
    ages, times = [], []
    for one in open_camera(f"replay:{recording}"):
        ages.append(time.monotonic() - one.t)
        times.append(one.t)
    assert time.monotonic() - begin >= 5 / 30
    assert times[0] >= begin
    assert np.diff(times) == pytest.approx([1 / 30] * 5)
    assert min(ages) >= 0.0


def test_faster(recording):
    begin = time.monotonic()
    times = [one.t for one in open_camera(f"replay:{recording}?speed=2")]
    assert time.monotonic() - begin >= 5 / 60
    assert times[0] == pytest.approx(10.0)


def test_round_and_round(recording):
    times = []
    for one in open_camera(f"replay:{recording}?speed=0&loop=1"):
        times.append(one.t)
        if len(times) == 20:
            break
    assert np.diff(times) == pytest.approx([1 / 30] * 19, abs=1e-8)


def test_closing_ends_the_wait(tmp_path):
    path = tmp_path / "x.mcap"
    with McapWriter(path) as writer:
        writer.write_frame(frame(0, t=1.0))
        writer.write_frame(frame(1, t=1000.0))
    camera, seen = open_camera(f"replay:{path}"), []
    thread = threading.Thread(target=lambda: seen.extend(camera))
    thread.start()
    while not seen:
        time.sleep(0.01)
    camera.close()
    camera.close()
    thread.join(60.0)
    assert not thread.is_alive()
    assert len(seen) == 1


def test_what_cannot_be_replayed(tmp_path):
    with McapWriter(tmp_path / "empty.mcap") as writer:
        writer.write_event(1.0, "nothing")
    with pytest.raises(CameraError, match="holds no frames"):
        list(open_camera(f"replay:{tmp_path / 'empty.mcap'}"))
    (tmp_path / "bad.mcap").write_bytes(b"nonsense")
    with pytest.raises(CameraError, match="is no MCAP file"):
        list(open_camera(f"replay:{tmp_path / 'bad.mcap'}"))
    for name in ("missing.mcap", "missing.mp4", "reach.jsonl", ""):
        with pytest.raises(CameraError):
            open_camera(f"replay:{tmp_path / name}")


def test_a_video(tmp_path):
    path = tmp_path / "film.avi"
    film = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 25.0, (64, 48))
    for k in range(5):
        film.write(np.full((48, 64, 3), 40 * k, np.uint8))
    film.release()
    camera = open_camera(f"replay:{path}?speed=0&fov=60")
    seen = list(camera)
    assert [one.t for one in seen] == pytest.approx([k / 25 for k in range(5)])
    assert [one.colour[5, 5, 0] for one in seen] == pytest.approx([0, 40, 80, 120, 160], abs=3)
    assert seen[0].depth is None
    assert camera.note is None


def test_a_real_video(shared_data):
    camera = open_camera(f"replay:{shared_data / 'images' / 'hand_720p.mp4'}?speed=0")
    assert "assumed" in camera.note
    for count, one in enumerate(camera):
        assert one.colour.shape == (720, 1280, 3)
        if count == 3:
            break
    assert one.t == pytest.approx(0.1, abs=0.01)
