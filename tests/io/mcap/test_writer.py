"""MCAP recordings: what is written is read back, by igrip and by the format's own library."""

import json
import struct
import threading

import cv2
import numpy as np
import pytest
from mcap.reader import make_reader

import igrip
from igrip import Observation
from igrip.errors import RecordingError
from igrip.io.mcap import foxglove
from igrip.io.mcap.messages import DetectedHand, Detections, Event
from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import McapWriter
from igrip.io.recordings.jsonl import JsonlWriter
from rgbd_frames import frame, same
from support import lines, run, scene_of_shapes


@pytest.fixture
def scene():
    """Observations of a scene."""
    return [Observation(**plain) for plain in scene_of_shapes(np.random.default_rng(1))]


def write(path, messages):
    with McapWriter(path) as writer:
        for message in messages:
            writer.write(message)
    return path


def test_round_trip(tmp_path, scene):
    reader = McapReader(write(tmp_path / "scene.mcap", scene))
    assert list(reader) == scene
    assert list(reader) == scene  # it may be iterated again
    assert reader.cut is None
    assert list(igrip.open_source(tmp_path / "scene.mcap")) == scene


def test_a_message_is_the_line_of_the_jsonl(tmp_path, scene):
    with JsonlWriter(tmp_path / "scene.jsonl") as writer:
        for observation in scene:
            writer.write(observation)
    records = McapReader(write(tmp_path / "scene.mcap", scene)).records(("/observations",))
    told = (tmp_path / "scene.jsonl").read_bytes().splitlines()
    assert [record.data for record in records] == told


def test_intentions_are_the_same_bit_for_bit(tmp_path, scene, shapes):
    with JsonlWriter(tmp_path / "scene.jsonl") as writer:
        for observation in scene:
            writer.write(observation)
    write(tmp_path / "scene.mcap", scene)

    def said(name):
        plain = [json.loads(o.to_json()) for o in igrip.open_source(tmp_path / name)]
        return lines(run(plain, shapes, igrip.Config(targets="paper")))

    assert said("scene.mcap") == said("scene.jsonl")


def test_frames_come_back(tmp_path):
    place = np.eye(4)
    place[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    place[:3, 3] = 0.1, -0.2, 1.3
    frames = [frame(k, camera="oak-1", place=place) for k in range(5)]
    frames += [frame(k, camera="webcam-0", depth=False) for k in range(5, 8)]
    frames += [frame(8, camera="oak-1")]  # it was moved
    with McapWriter(tmp_path / "x.mcap", lossless=True) as writer:
        for one in frames:
            writer.write_frame(one)
            writer.write(Observation(t=one.t))
    reader = McapReader(tmp_path / "x.mcap")
    again = list(reader.frames())
    assert all(same(a, b) for a, b in zip(again, frames, strict=True))
    assert [o.t for o in reader] == [f.t for f in frames]


def test_jpeg_is_close_and_depth_beyond_its_range_is_none(tmp_path):
    one = frame()
    smooth = np.broadcast_to(np.arange(64, dtype=np.uint8)[None, :, None] * 3, (48, 64, 3)).copy()
    one = igrip.rgbd.RgbdFrame(one.t, smooth, one.depth, one.intrinsics)
    one.depth[5, 5:8] = 6.6, np.nan, -1.0
    with McapWriter(tmp_path / "x.mcap") as writer:
        writer.write_frame(one)
    [again] = McapReader(tmp_path / "x.mcap").frames()
    assert np.abs(again.colour.astype(int) - smooth).max() < 8
    assert (again.depth[5, 5:8] == 0).all()
    one.depth[5, 5:8] = 0
    assert np.array_equal(again.depth, one.depth)


def test_other_libraries_read_it(tmp_path, scene):
    """Schemas describe themselves: the messages are decoded from the file's own descriptions."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet
    from google.protobuf.descriptor_pool import DescriptorPool
    from google.protobuf.message_factory import GetMessageClass

    with McapWriter(tmp_path / "x.mcap") as writer:
        for k in range(40):
            writer.write_frame(frame(k))
        writer.write(scene[0])
        writer.write_event(12.0, "button", which=2)
        hand = DetectedHand(landmarks=[(1.0, 2.0)], score=0.5, label="left")
        writer.write(Detections(t=12.0, camera="camera", hands=[hand]))
    with (tmp_path / "x.mcap").open("rb") as file:
        found = list(make_reader(file, validate_crcs=True).iter_messages())
    topics = {channel.topic for _, channel, _ in found}
    assert topics == {"/camera/colour", "/camera/depth", "/camera/calibration", "/tf",
                      "/camera/annotations",
                      "/observations", "/events", "/detections"}  # fmt: skip
    times = [message.log_time for _, _, message in found]
    assert times == sorted(times)
    told = [c.topic for _, c, _ in found].count("/camera/calibration")
    assert told == 2  # again after a second, for readers that seek
    for schema, channel, message in found:
        if schema.encoding == "jsonschema":
            described = json.loads(schema.data)
            assert described["type"] == "object"
            value = json.loads(message.data)
            assert set(described.get("required", ())) <= set(value) <= set(described["properties"])
            continue
        files = FileDescriptorSet.FromString(schema.data)
        pool = DescriptorPool()
        for part in files.file:
            pool.Add(part) if hasattr(pool, "Add") else pool.AddSerializedFile(
                part.SerializeToString()
            )
        decoded = GetMessageClass(pool.FindMessageTypeByName(schema.name)).FromString(message.data)
        stamp = decoded.timestamp
        assert stamp.seconds * 10**9 + stamp.nanos == message.log_time
        if channel.topic == "/camera/annotations":
            assert [(p.x, p.y) for p in decoded.points[0].points] == [(1.0, 2.0)]
            assert decoded.texts[0].text == "left 50%"
        if channel.topic == "/camera/calibration":
            assert list(decoded.K) == [60.0, 0, 31.5, 0, 61.0, 23.0, 0, 0, 1]


def test_further_fields(tmp_path):
    with McapWriter(tmp_path / "x.mcap") as writer:
        writer.write(Observation(t=1.0), recording="a")
    [record] = McapReader(tmp_path / "x.mcap").records()
    assert json.loads(record.data) == {"schema": "igrip/1", "t": 1.0, "recording": "a"}


def test_extreme_times_are_kept_exactly(tmp_path):
    observations = [Observation(t=t) for t in (0.0, 1e-12, 0.1 + 0.2, 1e12, 1e300)]
    assert list(McapReader(write(tmp_path / "x.mcap", observations))) == observations


@pytest.mark.parametrize(
    ("line", "field"),
    [
        (b"nonsense", "messages message: is not JSON"),
        (b'{"hands":{}}', "messages t: must be a number"),
        (b'{"t":5.0,"hands":{"right":{"position":[0,null,0]}}}', "hands.right position[1]: must"),
        (b'{"t":1.0}', "t steps back by 2 s"),
    ],
)
def test_a_malformed_message_costs_itself_and_is_named(tmp_path, line, field):
    path = tmp_path / "x.mcap"
    with McapWriter(path) as writer:
        writer.write(Observation(t=3.0))
        writer.write_event(3.0, "between")
        writer._put("/observations", 5.0, line)
    reader = McapReader(path)
    assert next(iter(reader)) == Observation(t=3.0)
    assert len(list(reader)) <= 2
    [counted] = [row for row in reader.defects.report() if row["what"] != "gap"]
    assert counted["first"] == "message 2 of /observations"
    assert f"{counted['path']} {counted['problem']}".startswith(field)


def test_a_file_without_one_good_message_names_the_first(tmp_path):
    path = tmp_path / "x.mcap"
    with McapWriter(path) as writer:
        writer._put("/observations", 5.0, b"nonsense")
    with pytest.raises(RecordingError) as raised:
        list(McapReader(path))
    assert f"{path}, message 1 of /observations: message: " in str(raised.value)


def test_a_file_of_others_is_answered_with_what_is_in_it(tmp_path):
    path = tmp_path / "x.mcap"
    with McapWriter(path) as writer:
        writer.write_event(3.0, "button")
        writer.write_event(4.0, "button")
    with pytest.raises(RecordingError, match=r"/events \(igrip\.Event\): 2 messages"):
        list(McapReader(path))


def test_a_malformed_picture_is_named(tmp_path):
    with McapWriter(tmp_path / "x.mcap") as writer:
        writer.write_frame(frame())
        writer._put("/camera/colour", 11.0, b"\x12\x03abc")
    with pytest.raises(RecordingError, match="message 2 of /camera/colour: data: is no picture"):
        list(McapReader(tmp_path / "x.mcap").frames())


@pytest.mark.parametrize("form", [".png", ".jpg"])
def test_a_picture_that_claims_to_be_huge(tmp_path, form):
    """Its header alone says so; nothing of that size may be taken from memory."""
    packed = bytearray(cv2.imencode(form, np.zeros((16, 16, 3), np.uint8))[1].tobytes())
    if form == ".png":
        packed[16:24] = struct.pack(">II", 30_000, 30_000)
    else:
        at = packed.index(b"\xff\xc0")
        packed[at + 5 : at + 9] = struct.pack(">HH", 30_000, 30_000)
    message = foxglove.schema("CompressedImage").message(data=bytes(packed))
    with pytest.raises(RecordingError, match="30000 × 30000 is too large"):
        foxglove.decode_picture(message.SerializeToString())


def test_a_picture_without_calibration(tmp_path):
    with McapWriter(tmp_path / "x.mcap") as writer:
        one = frame()
        writer._settled["camera"] = one.t, (one.intrinsics, one.world_from_camera.tobytes())
        writer.write_frame(one)
    with pytest.raises(RecordingError, match="no calibration"):
        list(McapReader(tmp_path / "x.mcap").frames())


@pytest.mark.parametrize("kind", ["missing", "folder"])
def test_files_that_cannot_be_opened(tmp_path, kind):
    path = tmp_path if kind == "folder" else tmp_path / "nowhere" / "x.mcap"
    for make in (McapReader, McapWriter):
        with pytest.raises(RecordingError) as raised:
            make(path)
        assert str(path) in str(raised.value)


def test_something_else(tmp_path):
    (tmp_path / "x.mcap").write_bytes(b'{"t":1.0}\n')
    with pytest.raises(RecordingError, match="is no MCAP file"):
        list(McapReader(tmp_path / "x.mcap"))


def test_several_threads(tmp_path):
    with McapWriter(tmp_path / "x.mcap") as writer:

        def work(number):
            for k in range(50):
                writer.write(Event(t=float(k), name=str(number)))
                writer.write_frame(frame(k, camera=f"c{number}"))

        threads = [threading.Thread(target=work, args=(n,)) for n in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    reader = McapReader(tmp_path / "x.mcap")
    assert sum(1 for _ in reader.frames()) == 150
    events = [json.loads(r.data) for r in reader.records(("/events",))]
    for number in range(3):
        own = [e["t"] for e in events if e["name"] == str(number)]
        assert own == [float(k) for k in range(50)]
