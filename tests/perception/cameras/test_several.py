"""Several cameras at once: the newest of each, none waits for another."""

import threading
import time

import numpy as np
import pytest

from igrip.errors import CameraError
from igrip.perception.cameras._several import PlacedCamera, SeveralCameras
from rgbd_frames import frame


class Stub:
    """A camera that gives what it is told, when it is told."""

    def __init__(self, name, count=None, error=None, note=None):
        self.name, self.count, self.error, self.note = name, count, error, note
        self.closed = threading.Event()
        self.go = threading.Event()
        self.go.set()

    def __iter__(self):
        k = 0
        while not self.closed.is_set() and k != self.count:
            yield frame(k, camera=self.name)
            k += 1
            self.go.wait()
            time.sleep(0.001)
        if self.error:
            raise self.error

    def close(self):
        self.go.set()
        self.closed.set()


def test_frames_of_both_each_in_order():
    cameras = SeveralCameras([Stub("a", 30), Stub("b", 40)])
    seen = {"a": [], "b": []}
    for one in cameras:
        seen[one.camera].append(one.t)
    for name, times in seen.items():
        assert times == sorted(set(times))
        assert times[-1] == frame({"a": 29, "b": 39}[name]).t  # the newest is never lost
    assert sum(map(len, seen.values())) + cameras.dropped == 70
    cameras.close()


def test_the_newest_wins_while_the_reader_is_busy():
    cameras = SeveralCameras([Stub("fast", 50), Stub("slow", 20)])
    iterator = iter(cameras)
    next(iterator)
    for thread in cameras._threads:
        thread.join(60.0)
    assert {one.camera: one.t for one in iterator} == {"fast": frame(49).t, "slow": frame(19).t}
    assert cameras.dropped == 70 - 3
    cameras.close()


def test_one_that_stands_still_does_not_hold_up_the_other():
    still = Stub("still")
    still.go.clear()
    cameras = SeveralCameras([still, Stub("other")])
    seen = []
    for one in cameras:
        seen.append(one.camera)
        if len(seen) == 20:
            break
    assert seen.count("other") >= 19
    cameras.close()


def test_an_error_of_one_is_raised():
    cameras = SeveralCameras([Stub("a"), Stub("b", 2, CameraError("b has stopped"))])
    with pytest.raises(CameraError, match="b has stopped"):
        for _ in cameras:
            pass
    cameras.close()


def test_closing_from_another_thread():
    still = [Stub("a"), Stub("b")]
    for stub in still:
        stub.go.clear()
    cameras = SeveralCameras(still)
    thread = threading.Thread(target=lambda: list(cameras))
    thread.start()
    cameras.close()
    cameras.close()
    thread.join(60.0)
    assert not thread.is_alive()
    assert all(stub.closed.is_set() for stub in still)


def test_notes():
    assert SeveralCameras([Stub("a", note="x"), Stub("b"), Stub("c", note="y")]).note == "x; y"
    assert PlacedCamera(Stub("a", note="x"), {}).note == "x"


def test_places():
    place = np.eye(4)
    place[:3, 3] = 1, 2, 3
    camera = PlacedCamera(Stub("a", 2), {"a": place})
    assert all(np.array_equal(one.world_from_camera, place) for one in camera)
    with pytest.raises(CameraError, match="where b stands is not known, only a: igrip calibrate"):
        next(iter(PlacedCamera(Stub("b", 2), {"a": place})))
