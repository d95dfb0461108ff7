"""RealSense cameras without one: the vendor's software device makes real frames of theirs."""

import time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from igrip.perception.cameras import CameraError, open_camera, realsense

WIDTH, HEIGHT = 64, 48


@pytest.fixture(scope="module")
def rs():
    pytest.importorskip(
        "pyrealsense2", reason="RealSense: pip install 'igrip[realsense]'", exc_type=ImportError
    )
    return realsense.load_realsense()


def intrinsics(rs, coeffs=(0, 0, 0, 0, 0), width=WIDTH, height=HEIGHT, scale=1.0):
    own = rs.intrinsics()
    own.width, own.height = width, height
    own.fx, own.fy, own.ppx, own.ppy = 60 * scale, 61 * scale, 31.5 * scale, 23.0 * scale
    own.model, own.coeffs = rs.distortion.brown_conrady, list(coeffs)
    return own


def frames(rs, count, coeffs=(0, 0, 0, 0, 0), shift=0.0, domain="global_time", age=0.02):
    """Yield sets of frames of a made-up camera: depth grows by 1 mm, colour is a ramp."""
    device = rs.software_device()
    sensors = device.add_sensor("Depth"), device.add_sensor("Color")
    streams = []
    for k, (kind, form, size) in enumerate(
        ((rs.stream.depth, rs.format.z16, 2), (rs.stream.color, rs.format.rgb8, 3))
    ):
        stream = rs.video_stream()
        stream.type, stream.index, stream.uid, stream.fmt, stream.bpp = kind, 0, k + 1, form, size
        stream.width, stream.height, stream.fps = WIDTH, HEIGHT, 30
        stream.intrinsics = intrinsics(rs, coeffs if k else (0,) * 5)
        streams.append(sensors[k].add_video_stream(stream))
    sensors[0].add_read_only_option(rs.option.depth_units, 0.001)
    aside = rs.extrinsics()
    aside.rotation, aside.translation = [1, 0, 0, 0, 1, 0, 0, 0, 1], [shift, 0, 0]
    streams[0].register_extrinsics_to(streams[1], aside)
    device.create_matcher(rs.matchers.dic)
    syncer = rs.syncer(10)
    for sensor, stream in zip(sensors, streams, strict=True):
        sensor.open(stream)
        sensor.start(syncer)
    ramp = np.repeat((np.arange(WIDTH) * 4)[None, :, None], HEIGHT, 0).repeat(3, 2)
    for k in range(count):
        now = (time.time() - age) * 1000
        for n, pixels in enumerate((np.full((HEIGHT, WIDTH), 800 + k, np.uint16), ramp)):
            frame = rs.software_video_frame()
            frame.pixels = np.ascontiguousarray(pixels, np.uint8 if n else np.uint16)
            frame.bpp = 3 if n else 2
            frame.stride, frame.timestamp = WIDTH * frame.bpp, now
            frame.domain, frame.frame_number = getattr(rs.timestamp_domain, domain), k
            frame.profile = streams[n].as_video_stream_profile()
            if not n:
                frame.depth_units = 0.001
            sensors[n].on_video_frame(frame)
        time.sleep(0.034)
        yield from iter_sets(syncer)
    for sensor in sensors:
        sensor.stop()
        sensor.close()


def iter_sets(syncer):
    while pair := syncer.poll_for_frames():
        yield pair


def converted(rs, converter, *more, **named):
    return [f for pair in frames(rs, *more, **named) if (f := converter.convert(pair))]


def test_frames(rs):
    seen = converted(rs, realsense.Converter(rs, "realsense-1", 0.001), 6)
    assert len(seen) >= 3
    for frame in seen:
        assert frame.intrinsics == (WIDTH, HEIGHT, 60.0, 61.0, 31.5, 23.0)
        assert frame.camera == "realsense-1"
        assert (frame.colour[:, :, 0] == np.arange(WIDTH) * 4).all()
    depths = [np.median(frame.depth[frame.depth > 0]) for frame in seen]
    assert np.diff(depths) == pytest.approx([0.001] * (len(seen) - 1), abs=1e-5)
    # exposed 20 ms before they were sent, on another clock
    assert all(0.02 <= time.monotonic() - frame.t < 60.0 for frame in seen)
    assert np.diff([f.t for f in seen]).min() > 0.02


def test_depth_that_was_sent_before_is_no_new_depth(rs):
    converter = realsense.Converter(rs, "x", 0.001)
    again = [(converter.convert(pair), converter.convert(pair)) for pair in frames(rs, 4)]
    assert sum(first is not None for first, _ in again) >= 2
    assert all(second is None for _, second in again)


def test_the_time_of_exposure_is_on_the_monotonic_clock(rs):
    converter = realsense.Converter(rs, "x", 0.001)
    for pair in frames(rs, 4, age=0.5):
        before = time.monotonic()
        frame = converter.convert(pair)
        if frame:
            assert 0.0 <= before - 0.5 - frame.t + 1e-3 < 0.5
    assert converter.note is None


def test_a_clock_of_its_own_gives_a_note(rs):
    converter = realsense.Converter(rs, "x", 0.001)
    [*_, frame] = converted(rs, converter, 4, domain="hardware_clock")
    assert abs(time.monotonic() - frame.t) < 5.0
    assert "has no time of exposure" in converter.note


def test_depth_is_aligned_to_colour(rs):
    """Depth from a place 5 cm aside lands f · 0.05 / 0.8 = 3.75 pixels aside."""
    [*_, frame] = converted(rs, realsense.Converter(rs, "x", 0.001), 4, shift=0.05)
    assert (frame.depth[24, :3] == 0).all()
    assert (frame.depth[24, 6:] > 0.79).all()


def test_the_lens_is_rectified(rs):
    coeffs = (0.1, 0.02, 0.001, -0.002, 0.0)
    [*_, frame] = converted(rs, realsense.Converter(rs, "x", 0.001), 4, coeffs=coeffs)
    own = intrinsics(rs, coeffs)
    k = np.array([[own.fx, 0, own.ppx], [0, own.fy, own.ppy], [0, 0, 1]])
    across, _ = cv2.initUndistortRectifyMap(
        k, np.array(coeffs), None, k, (WIDTH, HEIGHT), cv2.CV_32FC1
    )
    inside = np.s_[8:-8, 8:-8]
    assert np.abs(frame.colour[..., 0][inside] - 4 * across[inside]).max() < 1.5  # of 256 greys


def test_the_map_of_the_lens_is_opencvs(rs):
    """At a real size: interpolation costs less than a hundredth of a pixel."""
    coeffs = (0.1, -0.05, 0.001, -0.002, 0.01)
    own = intrinsics(rs, coeffs, 640, 480, 10.0)
    k = np.array([[own.fx, 0, own.ppx], [0, own.fy, own.ppy], [0, 0, 1]])
    there = cv2.initUndistortRectifyMap(k, np.array(coeffs), None, k, (640, 480), cv2.CV_32FC1)
    for mine, theirs in zip(realsense.lens_map(rs, own), there, strict=True):
        assert np.abs(mine - theirs).max() < 0.01


def test_no_device(rs):
    if len(rs.context().query_devices()):
        pytest.skip("a RealSense is plugged in here")
    with pytest.raises(CameraError, match="no RealSense camera is found: plug it"):
        open_camera("realsense")


class Pipeline:
    """As the vendor's: a pair or none in time, an error when it is unplugged."""

    def __init__(self, device):
        self.device, self.stopped, self.pairs = device, 0, []

    def start(self, config):
        return SimpleNamespace(get_device=lambda: self.device)

    def try_wait_for_frames(self, milliseconds):
        if self.pairs == ["unplugged"]:
            raise RuntimeError("Device disconnected")
        return (True, self.pairs.pop(0)) if self.pairs else (False, None)

    def stop(self):
        self.stopped += 1


def test_an_unplugged_device(rs, monkeypatch):
    set_options = []
    sensor = SimpleNamespace(
        supports=lambda option: True, set_option=lambda *pair: set_options.append(pair)
    )
    device = SimpleNamespace(
        get_info=lambda what: "123", query_sensors=lambda: [sensor],
        first_depth_sensor=lambda: SimpleNamespace(get_depth_scale=lambda: 0.001),
    )  # fmt: skip
    pipeline = Pipeline(device)
    monkeypatch.setattr(rs, "pipeline", lambda: pipeline)
    monkeypatch.setattr(rs, "context", lambda: SimpleNamespace(query_devices=lambda: [device]))
    camera = open_camera("realsense:123")
    assert camera.name == "realsense-123"
    assert set_options == [(rs.option.global_time_enabled, 1.0)]
    pipeline.pairs = list(frames(rs, 4))
    iterator = iter(camera)
    assert next(iterator).camera == "realsense-123"
    pipeline.pairs = ["unplugged"]
    with pytest.raises(CameraError, match=r"realsense-123 has stopped \(Device disconnected\)"):
        next(iterator)
    camera.close()
    camera.close()
    assert pipeline.stopped == 1
