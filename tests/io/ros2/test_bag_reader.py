"""Bags of ROS 2, written by the package rosbags."""

from __future__ import annotations

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

import igrip
from igrip.errors import RecordingError
from igrip.io.ros2.bag_reader import BagReader
from igrip.io.ros2.transforms import Pose, TransformTree

STORE = get_typestore(Stores.ROS2_HUMBLE)
BEGIN = 1_700_000_000_000_000_000  # ns
TF, POSE = "tf2_msgs/msg/TFMessage", "geometry_msgs/msg/PoseStamped"
STRING = "std_msgs/msg/String"
MUSTARD = "/vrpn/006_mustard_bottle/pose"


def make(kind, **fields):
    return STORE.types[kind](**fields)


def header(frame, ns):
    stamp = make("builtin_interfaces/msg/Time", sec=ns // 10**9, nanosec=ns % 10**9)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def point(kind, xyz):
    return make(f"geometry_msgs/msg/{kind}", x=float(xyz[0]), y=float(xyz[1]), z=float(xyz[2]))


def turn(q):
    q = [float(x) for x in q]
    return make("geometry_msgs/msg/Quaternion", x=q[0], y=q[1], z=q[2], w=q[3])


def transform(parent, child, ns, xyz, q=(0, 0, 0, 1)):
    return make(
        "geometry_msgs/msg/TransformStamped", header=header(parent, ns), child_frame_id=child,
        transform=make("geometry_msgs/msg/Transform", translation=point("Vector3", xyz),
                       rotation=turn(q)),
    )  # fmt: skip


def pose(frame, ns, xyz, q=(0, 0, 0, 1)):
    body = make("geometry_msgs/msg/Pose", position=point("Point", xyz), orientation=turn(q))
    return make(POSE, header=header(frame, ns), pose=body)


def hand_at(k):
    return [0.2, 0.005 * k, 0.05]


CAMERA = Rotation.from_euler("xyz", [0.3, -0.4, 2.0])
ORIGIN = np.array([0.5, 0.1, 0.9])


def write(folder, storage, damaged=()):
    """Write a hand in the frame of a camera, an object as poses, and a topic of text."""
    with Writer(folder, version=9, storage_plugin=storage) as bag:
        topics = {
            topic: bag.add_connection(topic, kind, typestore=STORE)
            for topic, kind in (("/tf", TF), ("/tf_static", TF), (MUSTARD, POSE),
                                ("/rosout", STRING))
        }  # fmt: skip

        def put(topic, ns, message):
            data = STORE.serialize_cdr(message, topics[topic].msgtype)
            bag.write(topics[topic], ns, data)

        camera = transform("world", "camera", BEGIN, ORIGIN, CAMERA.as_quat())
        put("/tf_static", BEGIN, make(TF, transforms=[camera]))
        put("/rosout", BEGIN, make(STRING, data="hello"))
        for k in range(60):
            ns = BEGIN + k * 33_333_333
            mustard = pose(
                "world", ns, [0.0, 0.4, 0.0], (0, 0, 0, 0) if k in damaged else (0, 0, 0, 1)
            )
            put(MUSTARD, ns, mustard)
            in_camera = CAMERA.inv().apply(np.array(hand_at(k)) - ORIGIN)
            hand = transform("camera", "right_hand", ns - 5_000_000, in_camera)
            put("/tf", ns, make(TF, transforms=[hand]))
    return folder


@pytest.fixture(params=[StoragePlugin.MCAP, StoragePlugin.SQLITE3], ids=["mcap", "db3"])
def bag(request, tmp_path):
    return write(tmp_path / "bag", request.param, damaged=(10, 11))


def files(folder):
    return [folder, *(path for path in folder.iterdir() if path.suffix in (".mcap", ".db3"))]


def test_transforms_and_poses_are_observations_in_the_root_frame(bag):
    for path in files(bag):  # the folder, and the file alone
        reader = igrip.open_source(path)
        observations = list(reader)
        hands = [o.hands["right"] for o in observations if "right" in o.hands]
        assert [h.position for h in hands] == [pytest.approx(hand_at(k)) for k in range(60)]
        # the first was measured before the bag begins
        timed = [o for o in observations if "right" in o.hands][1:]
        ages = [o.t - o.hands["right"].t for o in timed]
        assert ages == pytest.approx([0.005] * 59, abs=1e-6)
        mustard = [o.objects["006_mustard_bottle"] for o in observations if o.objects]
        seen = [m for m in mustard if m is not None and m.position[1] == pytest.approx(0.4)]
        assert len(seen) == 58
        assert mustard.count(None) == 2
        assert [row["what"] for row in reader.defects.report()] == ["not seen"]
        assert observations[0].t == 0.0


def test_pictures_are_left_out_of_the_observations_and_named(tmp_path):
    for storage in (StoragePlugin.MCAP, StoragePlugin.SQLITE3):
        for posed in (True, False):
            folder = tmp_path / f"{storage.name}{posed}"
            with Writer(folder, version=9, storage_plugin=storage) as bag:
                kinds = {"/cam/depth": "sensor_msgs/msg/Image"} | ({MUSTARD: POSE} if posed else {})
                topics = {t: bag.add_connection(t, k, typestore=STORE) for t, k in kinds.items()}
                empty = make("sensor_msgs/msg/Image", header=header("cam", BEGIN), height=1,
                             width=1, encoding="16UC1", is_bigendian=0, step=2,
                             data=np.zeros(2, np.uint8))  # fmt: skip
                for k in range(20):
                    ns = BEGIN + k * 33_333_333
                    data = {"/cam/depth": empty, MUSTARD: pose("world", ns, [0.0, 0.4, 0.0])}
                    for topic, connection in topics.items():
                        kind = connection.msgtype
                        bag.write(connection, ns, STORE.serialize_cdr(data[topic], kind))
            for path in files(folder):
                reader = igrip.open_source(path)
                if not posed:
                    with pytest.raises(RecordingError, match="igrip live --camera replay:"):
                        list(reader)
                    continue
                assert len(list(reader)) == 20
                [said] = [text for text in reader.remarks if text.startswith("left out")]
                assert "/cam/depth. Pictures are read as those of a camera" in said


def test_a_bag_replays_like_a_recording(bag):
    catalog = igrip.load_objects("ycb")
    estimator = igrip.Estimator(catalog)
    for observation in igrip.open_source(bag):
        estimator.update(observation)
    assert estimator.latest["right"].target == "006_mustard_bottle"


def test_a_bag_without_poses_is_answered_with_what_is_in_it(tmp_path):
    for storage in (StoragePlugin.MCAP, StoragePlugin.SQLITE3):
        folder = tmp_path / storage.name
        with Writer(folder, version=9, storage_plugin=storage) as bag:
            talk = bag.add_connection("/chatter", STRING, typestore=STORE)
            for k in range(3):
                data = STORE.serialize_cdr(make(STRING, data="hello"), STRING)
                bag.write(talk, BEGIN + k, data)
        for path in files(folder):
            with pytest.raises(
                RecordingError, match=r"/chatter \(std_msgs/msg/String\): 3 messages"
            ):
                list(igrip.open_source(path))


@pytest.mark.parametrize("storage", list(StoragePlugin), ids=lambda s: s.name)
@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_compressed_bags_are_read_as_folders(tmp_path, storage, mode):
    folder = tmp_path / "bag"
    writer = Writer(folder, version=9, storage_plugin=storage)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer as bag:
        topic = bag.add_connection("/tf", TF, typestore=STORE)
        for k in range(60):
            ns = BEGIN + k * 33_333_333
            hand = transform("world", "right_hand", ns, hand_at(k))
            bag.write(topic, ns, STORE.serialize_cdr(make(TF, transforms=[hand]), TF))
    hands = [o.hands["right"].position for o in igrip.open_source(folder)]
    assert hands == [pytest.approx(hand_at(k)) for k in range(60)]
    for path in files(folder)[1:]:  # without the metadata nothing says how they are compressed
        reader = igrip.open_source(path)
        with pytest.raises(RecordingError, match="open the folder of the bag"):
            list(reader)


def test_damaged_files_are_errors_of_recordings(tmp_path, bag):
    random = np.random.default_rng(0)
    for path in files(bag)[1:]:
        data = bytearray(path.read_bytes())
        for _ in range(60):
            broken = bytearray(data)
            for at in random.integers(0, len(data), 20):
                broken[at] ^= int(random.integers(1, 256))
            path.write_bytes(broken)
            for source in (path, bag):
                try:
                    list(igrip.open_source(source))
                except RecordingError as error:
                    assert str(tmp_path) in str(error)  # noqa: PT017


def test_a_folder_that_is_no_bag(tmp_path):
    with pytest.raises(RecordingError, match=r"metadata\.yaml"):
        BagReader(tmp_path)


def test_a_circle_of_frames_ends():
    tree, zero = TransformTree(), Pose(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    tree.set("a", "b", zero)
    tree.set("b", "a", zero)
    assert tree.in_root("a", zero).position == pytest.approx(np.zeros(3))
