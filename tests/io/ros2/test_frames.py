"""Pictures in bags of ROS 2, written by the package rosbags, as frames of cameras."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

from igrip.errors import RecordingError
from igrip.io.mcap.reader import McapReader
from igrip.io.ros2.bag_reader import BagReader
from igrip.perception.cameras import open_camera

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types
BEGIN = 1_700_000_000.0  # s
WIDTH, HEIGHT, F = 64, 48, 60.0
COLOUR, DEPTH = "/cam/color/image_raw", "/cam/aligned_depth_to_color/image_raw"
COUNT = 5


def colour(k: int) -> np.ndarray:
    picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    picture[:, :, 0] = np.arange(WIDTH) + k
    picture[:, :, 1] = np.arange(HEIGHT)[:, None]
    picture[10:20, 10:30, 2] = 200
    return picture


def depth(k: int) -> np.ndarray:
    picture = np.full((HEIGHT, WIDTH), 0.8 + 0.01 * k)
    picture[:5] = 0.0
    return picture


def header(frame, t):
    stamp = TYPES["builtin_interfaces/msg/Time"](sec=int(t), nanosec=round(t % 1.0 * 1e9))
    return TYPES["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)


def image(t, pixels, encoding, frame="cam_optical", pad=0):
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(len(pixels), -1)
    rows = np.pad(rows, ((0, 0), (0, pad)))
    return TYPES["sensor_msgs/msg/Image"](
        header=header(frame, t), height=pixels.shape[0], width=pixels.shape[1], encoding=encoding,
        is_bigendian=0, step=rows.shape[1], data=rows.ravel(),
    )  # fmt: skip


def compressed(t, data, form, frame="cam_optical"):
    return TYPES["sensor_msgs/msg/CompressedImage"](
        header=header(frame, t), format=form, data=np.frombuffer(data, np.uint8)
    )


def info(t, f=F, d=()):
    roi = TYPES["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    k = np.array([f, 0, (WIDTH - 1) / 2, 0, f, (HEIGHT - 1) / 2, 0, 0, 1.0])
    return TYPES["sensor_msgs/msg/CameraInfo"](
        header("cam_optical", t), HEIGHT, WIDTH, "plumb_bob", np.array(d, dtype=np.float64), k,
        np.eye(3).ravel(), np.zeros(12), 0, 0, roi,
    )  # fmt: skip


def tf(t, parent, child, xyz, q):
    vector, quaternion = TYPES["geometry_msgs/msg/Vector3"], TYPES["geometry_msgs/msg/Quaternion"]
    one = TYPES["geometry_msgs/msg/TransformStamped"](
        header(parent, t),
        child,
        TYPES["geometry_msgs/msg/Transform"](vector(*xyz), quaternion(*map(float, q))),
    )
    return TYPES["tf2_msgs/msg/TFMessage"]([one])


def written(path: Path, messages, plugin=StoragePlugin.SQLITE3) -> Path:
    """Write (topic, time, message) into a bag, in the order of their times."""
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for topic, t, message in sorted(messages, key=lambda one: one[1]):
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            data = STORE.serialize_cdr(message, kind)
            writer.write(connections[topic], round(t * 1e9), data)
    return path


def rgbd(encode_colour=None, encode_depth=None, late=0.004, **calibration):
    """Return the messages of a camera; depth comes a little after its colour."""
    encode_colour = encode_colour or (lambda t, k: image(t, colour(k), "rgb8"))
    encode_depth = encode_depth or (
        lambda t, k: image(t, (depth(k) * 1000).round().astype("<u2"), "16UC1")
    )
    messages = []
    for k in range(COUNT):
        t = BEGIN + 0.1 * k
        messages += [
            ("/cam/color/camera_info", t, info(t, **calibration)),
            (COLOUR, t + 0.001, encode_colour(t, k)),
            (DEPTH, t + late, encode_depth(t + late, k)),
        ]
    return messages


def assert_frames(frames, mean_error=0.0):
    assert len(frames) == COUNT
    for k, frame in enumerate(frames):
        assert frame.camera == "cam"
        assert frame.t == pytest.approx(0.1 * k, abs=1e-6)
        assert np.abs(frame.colour.astype(int) - colour(k)).mean() <= mean_error
        assert_allclose(frame.depth, depth(k), atol=6e-4)
        assert tuple(frame.intrinsics) == (WIDTH, HEIGHT, F, F, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_colour_and_depth_of_one_camera(tmp_path, plugin):
    path = written(tmp_path / "bag", rgbd(), plugin)
    assert_frames(list(BagReader(path).frames()))


def test_a_single_file_without_its_folder(tmp_path):
    path = written(tmp_path / "bag", rgbd(), StoragePlugin.MCAP)
    assert_frames(list(McapReader(path / "bag.mcap").frames()))
    path = written(tmp_path / "other", rgbd())
    assert_frames(list(BagReader(path / "other.db3").frames()))


@pytest.mark.parametrize(
    ("encoding", "pixels"),
    [
        ("bgr8", lambda k: colour(k)[:, :, ::-1]),
        ("rgba8", lambda k: np.dstack([colour(k), np.full((HEIGHT, WIDTH), 255, np.uint8)])),
        ("bgra8", lambda k: np.dstack([colour(k)[:, :, ::-1], colour(k)[:, :, :1]])),
    ],
)  # fmt: skip
def test_encodings_of_colour(tmp_path, encoding, pixels):
    path = written(tmp_path / "bag", rgbd(lambda t, k: image(t, pixels(k), encoding, pad=7)))
    assert_frames(list(BagReader(path).frames()))


def test_depth_in_metres_with_nan(tmp_path):
    def encode(t, k):
        return image(t, np.where(depth(k) > 0, depth(k), np.nan).astype("<f4"), "32FC1")

    path = written(tmp_path / "bag", rgbd(encode_depth=encode))
    assert_frames(list(BagReader(path).frames()))


def test_packed_pictures(tmp_path):
    def jpeg(t, k):
        data = cv2.imencode(".jpg", colour(k)[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 100])[1]
        return compressed(t, data.tobytes(), "rgb8; jpeg compressed bgr8")

    def png(t, k):
        data = cv2.imencode(".png", (depth(k) * 1000).round().astype(np.uint16))[1]
        return compressed(t, bytes(12) + data.tobytes(), "16UC1; compressedDepth")

    messages = [
        (topic + {COLOUR: "/compressed", DEPTH: "/compressedDepth"}.get(topic, ""), t, message)
        for topic, t, message in rgbd(jpeg, png)
    ]
    assert_frames(list(BagReader(written(tmp_path / "bag", messages)).frames()), mean_error=2.0)


def test_the_camera_stands_where_the_transforms_put_it(tmp_path):
    turn = Rotation.from_euler("xyz", [0.3, -0.4, 2.0])
    optical = Rotation.from_euler("xyz", [-np.pi / 2, 0, -np.pi / 2])
    messages = rgbd()
    messages += [
        ("/tf_static", BEGIN - 0.2, tf(BEGIN, "world", "link", [0.5, 0.1, 0.9], turn.as_quat())),
        ("/tf_static", BEGIN - 0.1, tf(BEGIN, "link", "cam_optical", [0, 0.02, 0],
                                       optical.as_quat())),
    ]  # fmt: skip
    *_, frame = BagReader(written(tmp_path / "bag", messages)).frames()
    expected = np.eye(4)
    expected[:3, :3] = (turn * optical).as_matrix()
    expected[:3, 3] = np.array([0.5, 0.1, 0.9]) + turn.apply([0, 0.02, 0])
    assert_allclose(frame.world_from_camera, expected, atol=1e-9)


def test_distortion_is_taken_out(tmp_path):
    d = [0.3, -0.1, 0.0, 0.0, 0.0]
    frames = list(BagReader(written(tmp_path / "bag", rgbd(d=d))).frames())
    matrix = frames[0].intrinsics.matrix
    expected = cv2.undistort(colour(0), matrix, np.array(d)).astype(int)
    assert np.abs(frames[0].colour.astype(int) - colour(0)).max() > 100
    assert np.abs(frames[0].colour - expected)[10:-10, 10:-10].max() <= 4


def test_depth_that_is_not_aligned_is_left_out_and_named(tmp_path):
    def other(t, k):
        return image(t, (depth(k) * 1000).astype("<u2"), "16UC1", frame="cam_depth_optical")

    messages = [
        (topic.replace("aligned_depth_to_color", "depth"), t, message)
        for topic, t, message in rgbd(encode_depth=other)
    ]
    reader = BagReader(written(tmp_path / "bag", messages))
    frames = list(reader.frames())
    assert [frame.depth for frame in frames] == [None] * COUNT
    assert any("/cam/depth/image_raw: is not aligned" in remark for remark in reader.remarks)


def test_colour_alone(tmp_path):
    messages = [one for one in rgbd() if one[0] != DEPTH]
    frames = list(BagReader(written(tmp_path / "bag", messages)).frames())
    assert [round(frame.t, 6) for frame in frames] == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert all(frame.depth is None for frame in frames)


def test_without_a_calibration_the_topic_to_record_is_named(tmp_path):
    messages = [one for one in rgbd() if "camera_info" not in one[0]]
    with pytest.raises(RecordingError, match="record /cam/color/camera_info too"):
        list(BagReader(written(tmp_path / "bag", messages)).frames())


def test_a_bag_without_pictures_names_what_it_holds(tmp_path):
    path = written(tmp_path / "bag", [("/tf", BEGIN, tf(BEGIN, "a", "b", [0, 0, 0], [0, 0, 0, 1]))])
    with pytest.raises(RecordingError, match=r"no colour pictures; it holds /tf \(tf2_msgs"):
        list(BagReader(path).frames())


def test_two_cameras_keep_their_names(tmp_path):
    messages = rgbd() + [
        (topic.replace("/cam/", "/side/"), t + 0.03, message) for topic, t, message in rgbd()
    ]
    frames = list(BagReader(written(tmp_path / "bag", messages)).frames())
    assert sorted({frame.camera for frame in frames}) == ["cam", "side"]
    assert len(frames) == 2 * COUNT


def test_a_bag_replaces_a_camera(tmp_path):
    path = written(tmp_path / "bag", rgbd())
    camera = open_camera(f"replay:{path}?speed=0")
    try:
        assert_frames(list(camera))
    finally:
        camera.close()
