"""OAK cameras without one: depthai's own host nodes join and convert; the rest is a stand-in."""

import os
import threading
import time
from datetime import timedelta

import numpy as np
import pytest

from fake_depthai import HEIGHT, MATRIX, WIDTH, FakeDai, pair
from igrip.perception.cameras import CameraError, oak, open_camera


@pytest.fixture(scope="module")
def dai():
    pytest.importorskip("depthai", reason="OAK cameras: pip install 'igrip[oak]'")
    return oak.load_depthai()


def test_telemetry_is_off(dai):
    assert os.environ["DEPTHAI_TELEMETRY"] == "0"


def test_its_clock_is_the_hosts(dai):
    offset = oak.clock_offset(dai)
    assert dai.Clock.now().total_seconds() + offset == pytest.approx(time.monotonic(), abs=0.05)


@pytest.mark.parametrize("name", ["oak", "oak:1234567890"])
def test_no_device(dai, name):
    if dai.Device.getAllAvailableDevices():
        pytest.skip("an OAK is plugged in here")
    with pytest.raises(CameraError, match="no OAK camera is found: plug it in"):
        open_camera(name)


def test_joining_and_converting_by_depthai_itself(dai):
    """Pictures of two sources, 4 ms apart, some of them lost."""

    class Source(dai.node.ThreadedHostNode):
        def __init__(self, colour):
            dai.node.ThreadedHostNode.__init__(self)
            self.out = self.createOutput()
            self.colour = colour

        def run(self):
            for k in range(1000):
                if not self.isRunning():
                    return
                picture = dai.ImgFrame()
                if self.colour:
                    picture.setFrame(np.full((HEIGHT, WIDTH, 3), [k % 256, 1, 2], np.uint8))
                    picture.setType(dai.ImgFrame.Type.RGB888i)
                else:
                    picture.setFrame(np.full((HEIGHT, WIDTH), 500 + k, np.uint16))
                    picture.setType(dai.ImgFrame.Type.RAW16)
                picture.setWidth(WIDTH)
                picture.setHeight(HEIGHT)
                picture.setTimestamp(timedelta(seconds=100 + k / 30 + 0.004 * (not self.colour)))
                picture.setSequenceNum(k)
                if k % 5 != 2 + self.colour:
                    self.out.send(picture)
                time.sleep(0.005)

    pipeline = dai.Pipeline(False)
    with pipeline:
        colour, depth = pipeline.create(Source, True), pipeline.create(Source, False)
        queue = oak.join(dai, pipeline, colour.out, depth.out, 30.0, on_host=True)
        pipeline.start()
        seen = []
        for _ in range(8):
            group = queue.get(timedelta(seconds=5))
            assert group is not None
            seen.append(oak.frame_of(dai, group, "oak-1", 7.0, lambda w, h: MATRIX))
        pipeline.stop()
    for frame in seen:
        k = round((frame.t - 107) * 30)
        assert frame.t == pytest.approx(107 + k / 30, abs=1e-5)
        assert (frame.colour == [k % 256, 1, 2]).all()
        assert np.allclose(frame.depth, (500 + k) / 1000)  # of the same moment
        assert k % 5 not in (2, 3)
        assert frame.intrinsics == (WIDTH, HEIGHT, 50.0, 51.0, 31.5, 23.5)
    times = [frame.t for frame in seen]
    assert times == sorted(set(times))


def test_intrinsics_are_those_of_the_picture_that_was_sent(dai):
    picture, depth = dai.ImgFrame(), dai.ImgFrame()
    picture.setFrame(np.zeros((HEIGHT, WIDTH, 3), np.uint8))
    picture.setType(dai.ImgFrame.Type.RGB888i)
    depth.setFrame(np.zeros((HEIGHT, WIDTH), np.uint16))
    depth.setType(dai.ImgFrame.Type.RAW16)
    for one in (picture, depth):
        one.setWidth(WIDTH)
        one.setHeight(HEIGHT)
    told = dai.ImgTransformation(WIDTH, HEIGHT, [[60, 0, 32], [0, 61, 24], [0, 0, 1]])
    picture.setTransformation(told)
    group = {"colour": picture, "depth": depth}
    frame = oak.frame_of(dai, group, "oak-1", 0.0, lambda w, h: MATRIX)
    assert frame.intrinsics == (WIDTH, HEIGHT, 60.0, 61.0, 32.0, 24.0)


# with a stand-in for the device -------------------------------------------------------------------


@pytest.fixture
def fake(monkeypatch):
    fake = FakeDai()
    monkeypatch.setattr(oak, "load_depthai", lambda: fake)
    return fake


def test_frames_of_a_device(fake):
    camera = open_camera("oak:XYZ?size=64x48&fps=15")
    base = time.monotonic() - 1001.0  # a second ago on this clock
    fake.queue.groups += [pair(base + k / 15, k) for k in (0, 1, 1, 2)]
    frames = []
    for frame in camera:
        frames.append(frame)
        if len(frames) == 3:
            break
    camera.close()
    camera.close()
    assert [f.colour[0, 0, 0] for f in frames] == [0, 1, 2]  # the repeated one is left out
    assert [f.depth[0, 0] for f in frames] == pytest.approx([0.7, 0.701, 0.702])
    assert frames[0].camera == camera.name == "oak-XYZ"
    assert frames[0].t == pytest.approx(base + 1000.0, abs=0.05)
    assert np.diff([f.t for f in frames]) == pytest.approx([1 / 15] * 2, abs=0.05)
    assert fake.device.closed == 1
    asked = [named for kind, name, _, named in fake.calls if "requestOutput" in name]
    assert {"type": "rgb", "fps": 15.0, "enableUndistortion": True} in asked


def test_alignment_by_chip(fake, monkeypatch):
    open_camera("oak?size=64x48").close()
    assert ("camera.build.requestOutput", "stereo.inputAlignTo") in fake.links()
    assert ("stereo.depth", "sync.depth") in fake.links()
    later = FakeDai("RVC4")
    monkeypatch.setattr(oak, "load_depthai", lambda: later)
    open_camera("oak?size=64x48").close()
    assert ("stereo.depth", "align.input") in later.links()
    assert ("align.outputAligned", "sync.depth") in later.links()


def test_unplugged(fake):
    camera = open_camera("oak?size=64x48")
    fake.queue.groups.append(pair(1.0))
    iterator = iter(camera)
    next(iterator)
    fake.queue.closed.set()
    with pytest.raises(CameraError, match=r"oak-XYZ has stopped .*still plugged in"):
        next(iterator)
    camera.close()


def test_stopped_by_itself(fake):
    camera = open_camera("oak?size=64x48")
    fake.running = False
    with pytest.raises(CameraError, match="still plugged in"):
        next(iter(camera))


def test_silence(fake, monkeypatch):
    monkeypatch.setattr("igrip.perception.cameras._polled.PATIENCE", 0.05)
    camera = open_camera("oak?size=64x48")
    fake.queue.groups.append(pair(1.0))
    iterator = iter(camera)
    next(iterator)
    with pytest.raises(CameraError, match=r"for 0.05 s oak-XYZ has sent no picture; is it still"):
        next(iterator)
    monkeypatch.setattr("igrip.perception.cameras._polled.WARM_UP", 0.05)
    with pytest.raises(CameraError, match="has sent no picture"):
        next(iter(camera))


def test_closing_from_another_thread_ends_the_wait(fake):
    camera = open_camera("oak?size=64x48")
    frames = []
    thread = threading.Thread(target=lambda: frames.extend(camera))
    thread.start()
    camera.close()
    thread.join(60.0)
    assert not thread.is_alive()
    assert frames == []


def test_depth_that_is_not_aligned_is_no_frame(fake):
    camera = open_camera("oak?size=64x48")
    fake.queue.groups.append(pair(1.0, shape=(40, 64)))
    with pytest.raises(CameraError, match="is not aligned"):
        next(iter(camera))


def test_a_camera_without_stereo(monkeypatch):
    fake = FakeDai(stereo=False)
    monkeypatch.setattr(oak, "load_depthai", lambda: fake)
    with pytest.raises(CameraError, match="no stereo pair"):
        open_camera("oak?size=64x48")


def test_an_odd_width():
    with pytest.raises(CameraError, match="multiple of 16"):
        open_camera("oak?size=100x48")


def test_depthai_has_every_name_that_is_used(dai):
    """What cannot be called without a device is at least there."""
    used = {
        dai: ("Device", "DeviceInfo", "Pipeline", "Clock"),
        dai.Device: ("getAllAvailableDevices", "getDeviceId", "getConnectedCameras", "getPlatform",
                     "readCalibration", "close"),
        dai.Pipeline: ("create", "start", "stop", "isRunning"),
        dai.Platform: ("RVC2", "RVC4"),
        dai.CameraBoardSocket: ("CAM_A", "CAM_B", "CAM_C"),
        dai.CameraExposureOffset: ("MIDDLE",),
        dai.ImgFrame.Type: ("RGB888i",),
        dai.CalibrationHandler: ("getCameraIntrinsics",),
        dai.node.Camera: ("build", "requestOutput"),
        dai.node.StereoDepth: ("setDefaultProfilePreset", "setLeftRightCheck", "setSubpixel",
                               "inputAlignTo", "left", "right", "depth"),
        dai.node.StereoDepth.PresetMode: ("ROBOTICS",),
        dai.node.ImageAlign: ("input", "inputAlignTo", "outputAligned"),
        dai.node.Sync: ("setRunOnHost", "setSyncThreshold", "inputs", "out"),
    }  # fmt: skip
    for owner, names in used.items():
        assert [name for name in names if not hasattr(owner, name)] == []
    assert "enableUndistortion" in dai.node.Camera.requestOutput.__doc__
