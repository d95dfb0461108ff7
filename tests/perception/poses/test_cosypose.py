"""The client of CosyPose against a stand-in that speaks its real data shapes, and misbehaves.

The stand-in is the real server script with another estimator: HappyPose itself is not run here.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import socket
import struct
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.errors import IgripError
from igrip.perception.poses import POSES
from igrip.perception.poses.cosypose import LABELS
from igrip.rgbd import Intrinsics, RgbdFrame

SCRIPT = Path(__file__).parents[3] / "docs" / "cosypose" / "server.py"
CAMERA = Intrinsics(64, 48, 60.0, 61.0, 31.0, 23.0)
MUSTARD = "006_mustard_bottle"
LIMIT = 60.0  # s that an answer is waited for: only a failing test ever does
TURN = Rotation.from_euler("xyz", [0.3, -0.8, 1.9]).as_matrix()


def load_server():
    spec = importlib.util.spec_from_file_location("cosypose_server", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def found(label="ycbv-obj_000005", score=0.93, place=(0.01, -0.02, 0.8), turn=TURN):
    pose = np.eye(4, dtype=np.float32)
    pose[:3, :3], pose[:3, 3] = turn, place
    return {"label": label, "score": score, "camera_from_object": pose.astype(float).tolist()}


@pytest.fixture
def serve():
    """Start the real server script round an estimator; return its port."""
    running = []

    def start(estimate):
        server = load_server().Server(("127.0.0.1", 0), estimate)
        thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
        thread.start()
        running.append(server)
        return server.server_address[1]

    yield start
    for server in running:
        server.shutdown()
        server.server_close()


@pytest.fixture
def speak():
    """Start a server that treats each connection by a function of its socket; return its port."""
    sockets = []

    def start(*treatments):
        listening = socket.create_server(("127.0.0.1", 0))
        sockets.append(listening)

        def run():
            for treat in treatments:
                with contextlib.suppress(OSError):
                    connection, _ = listening.accept()
                    sockets.append(connection)
                    treat(connection)

        threading.Thread(target=run, daemon=True).start()
        return listening.getsockname()[1]

    yield start
    for each in sockets:
        each.close()


@pytest.fixture
def client(ycb):
    made = []

    def make(port, **options):
        made.append(POSES.get("cosypose")(ycb, {"port": port, "wait": LIMIT, **options}))
        return made[-1]

    yield make
    for each in made:
        each.close()
        each.close()


def frame(t, value=7, world=None, depth=None):
    colour = np.full((48, 64, 3), value, np.uint8)
    world = np.eye(4) if world is None else world
    return RgbdFrame(t, colour, depth, CAMERA, world_from_camera=world)


def read_frame(connection):
    stream = connection.makefile("rb")
    (length,) = struct.unpack(">I", stream.read(4))
    header = json.loads(stream.read(length))
    stream.read(header["width"] * header["height"] * 3)
    return header


def say(connection, words):
    connection.sendall(struct.pack(">I", len(words)) + words)


def test_the_labels_are_the_catalogues_names(ycb):
    assert len(LABELS) == 21
    assert all(name in ycb for name in LABELS.values())
    # the four of the paper, as HappyPose numbers them
    assert [LABELS[f"ycbv-obj_{n:06d}"][:3] for n in (2, 4, 5, 12)] == ["003", "005", "006", "021"]


def test_a_pose_of_the_box_becomes_one_of_the_mesh_in_the_world(serve, client, ycb):
    asked = []
    port = serve(lambda colour, depth, matrix: asked.append((colour, depth, matrix)) or [found()])
    world = np.eye(4)
    world[:3, :3] = Rotation.from_euler("x", -120, degrees=True).as_matrix()
    world[:3, 3] = [0.5, 0.2, 0.7]
    told = client(port).estimate(frame(3.5, world=world))
    assert set(told) == {MUSTARD}
    pose = told[MUSTARD]
    assert (pose.model, pose.t, pose.source) == (MUSTARD, 3.5, "cosypose")
    assert pose.score == pytest.approx(0.93)
    # where the box's middle is, in both ways of saying it
    vertices = ycb[MUSTARD].vertices
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    turn = Rotation.from_quat(pose.orientation).as_matrix()
    expected = world[:3, :3] @ [0.01, -0.02, 0.8] + world[:3, 3]
    np.testing.assert_allclose(turn @ middle + pose.position, expected, atol=1e-6)
    np.testing.assert_allclose(turn, world[:3, :3] @ TURN, atol=1e-6)
    colour, depth, matrix = asked[0]
    assert colour.shape == (48, 64, 3)
    assert (colour == 7).all()
    assert depth is None
    np.testing.assert_array_equal(matrix, CAMERA.matrix)


def test_depth_goes_along_where_it_is_asked_for(serve, client):
    seen = []
    port = serve(lambda colour, depth, matrix: seen.append(depth) or [])
    depth = np.linspace(0.3, 2.0, 48 * 64, dtype=np.float32).reshape(48, 64)
    client(port, send_depth=True).estimate(frame(0.0, depth=depth))
    np.testing.assert_array_equal(seen[0], depth)


def test_the_surest_of_an_object_counts_and_what_is_unknown_or_unsure_does_not(serve, client):
    poses = [
        found(score=0.8, place=(0.1, 0.0, 0.9)), found(), found("ycbv-obj_000099"),
        found("ycbv-obj_000004", 0.5), found("ycbv-obj_000002", 0.9),
    ]  # fmt: skip
    told = client(serve(lambda *_: poses), models=[MUSTARD, "005_tomato_soup_can"]).estimate(
        frame(0.0)
    )
    assert set(told) == {MUSTARD}
    assert told[MUSTARD].score == pytest.approx(0.93)


def test_what_is_not_found_keeps_its_pose_and_time_and_is_then_gone(serve, client):
    port = serve(lambda colour, *_: [found()] if colour[0, 0, 0] == 7 else [])
    estimator = client(port)
    told = estimator.estimate(frame(0.0))
    assert estimator.estimate(frame(1.0, value=0)) == told
    pixel = CAMERA.pixels(np.array([[0.01, -0.02, 0.8]]))
    hand = pixel + np.random.default_rng(0).uniform(-8, 8, (21, 2))
    assert estimator.estimate(frame(2.5, value=0), [hand]) == told
    assert estimator.estimate(frame(2.6, value=0)) == {MUSTARD: None}
    assert estimator.estimate(frame(2.7, value=0)) == {}
    assert estimator.estimate(frame(0.0, value=0)) == {}  # another run


def estimate_until(estimator, done, t):
    """Send frames of the same time until an answer is as it should be; return it."""
    end = time.monotonic() + LIMIT
    while not done(poses := estimator.estimate(frame(t, value=60))):
        assert time.monotonic() < end
        time.sleep(0.005)
    return poses


def test_nothing_waits_and_only_the_newest_frame_is_sent(serve, client):
    release, begun, asked = threading.Event(), threading.Event(), []

    def slow(colour, *_):
        asked.append(int(colour[0, 0, 0]))
        begun.set()
        assert release.wait(LIMIT)
        return [found()]

    estimator = client(serve(slow), wait=0.0)
    for k in range(50):  # would wait for good if it waited
        assert estimator.estimate(frame(k / 30, value=k)) == {}
        assert begun.wait(LIMIT)
    release.set()
    estimate_until(estimator, lambda poses: poses and poses[MUSTARD].t >= 49 / 30, 2.0)
    assert asked[0] == 0
    assert min(asked[1:]) >= 49  # the 48 in between were never sent


def test_late_answers_carry_the_time_of_their_frame(serve, client):
    begun, release = threading.Event(), threading.Event()

    def slow(colour, *_):
        begun.set()
        assert release.wait(LIMIT)
        return [found()] if colour[0, 0, 0] == 7 else []

    estimator = client(serve(slow), wait=0.0)
    assert estimator.estimate(frame(1.0)) == {}
    assert begun.wait(LIMIT)
    assert estimator.estimate(frame(1.5, value=60)) == {}
    release.set()
    assert estimate_until(estimator, bool, 2.0)[MUSTARD].t == 1.0


def test_an_estimator_that_fails_is_told_of_and_the_next_frame_may_do(serve, client, capsys):
    def fails(colour, *_):
        if colour[0, 0, 0] == 0:
            raise RuntimeError("out of memory")
        return [found()]

    estimator = client(serve(fails))
    assert estimator.estimate(frame(0.0, value=0)) == {}
    assert "out of memory" in estimator.problem
    assert set(estimator.estimate(frame(0.1))) == {MUSTARD}
    assert estimator.problem is None
    capsys.readouterr()


def test_where_nobody_listens_it_says_what_to_start(ycb):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with pytest.raises(IgripError, match=r"no pose server listens .*docs/cosypose\.md"):
        POSES.get("cosypose")(ycb, {"port": port})


def good(connection):
    header = read_frame(connection)
    say(connection, json.dumps({"seq": header["seq"], "poses": [found()]}).encode())


@pytest.mark.parametrize(
    "answer",
    [
        b"no json", b"[]", b"{}", b'{"seq": 12345, "poses": []}', b'{"seq": 1, "poses": 3}',
        b"[" * 100_000, b"\xff\xfe", b'{"seq": 1}',
    ],
)  # fmt: skip
def test_garbage_is_not_believed_and_the_connection_made_anew(speak, client, answer):
    def garbage(connection):
        read_frame(connection)
        say(connection, answer)

    estimator = client(speak(garbage, good))
    assert estimator.estimate(frame(0.0)) == {}
    assert "pose server" in estimator.problem
    assert set(estimator.estimate(frame(0.1))) == {MUSTARD}


def test_a_server_that_dies_is_waited_for(speak, client):
    def dies(connection):
        good(connection)
        connection.close()

    estimator = client(speak(dies, good))
    told = estimator.estimate(frame(0.0))
    assert set(told) == {MUSTARD}
    assert estimator.estimate(frame(0.1)) == told  # nothing new: the old pose, its old time
    assert estimator.problem is not None
    assert estimator.estimate(frame(0.2))[MUSTARD].t == 0.2


def test_a_server_that_never_answers_is_given_up(speak, client):
    estimator = client(speak(read_frame, *[good] * 100), timeout=0.5)
    assert estimator.estimate(frame(0.0)) == {}
    assert "timed out" in estimator.problem
    assert set(estimate_until(estimator, bool, 0.1)) == {MUSTARD}


def test_a_length_that_makes_no_sense_is_not_read(speak, client):
    def huge(connection):
        read_frame(connection)
        connection.sendall(b"\xff\xff\xff\xff")

    estimator = client(speak(huge, good))
    assert estimator.estimate(frame(0.0)) == {}
    assert "reply cannot be read" in estimator.problem


BAD = [
    None, 3, {}, {**found(), "score": "high"}, {**found(), "score": float("nan")},
    {**found(), "camera_from_object": [1, 2, 3]}, found(place=(0.0, 0.0, -0.5)),
    found(place=(0.0, np.nan, 0.5)), found(turn=2.0 * TURN), found(turn=-TURN),
    found(turn=np.zeros((3, 3))), {**found(), "camera_from_object": [["a"] * 4] * 4},
]  # fmt: skip


@pytest.mark.parametrize("bad", BAD)
def test_what_is_no_pose_is_left_out(serve, client, bad):
    told = client(serve(lambda *_: [bad, found("ycbv-obj_000004")])).estimate(frame(0.0))
    assert set(told) == {"005_tomato_soup_can"}


def test_options_that_make_no_sense_are_refused(ycb):
    for options in ({"port": 0}, {"prot": 1}, {"wait": -1}):
        with pytest.raises(IgripError, match=next(iter(options))):
            POSES.get("cosypose")(ycb, options)


TRUE = {  # of the real frame: centre of the box [m], quaternion x, y, z, w
    2: ((0.0552, -0.0913, 1.0283), (0.2279, 0.1563, 0.0245, 0.9607)),
    5: ((0.0946, -0.0123, 0.8399), (-0.4171, 0.7404, -0.4506, -0.2730)),
    15: ((-0.1013, 0.0329, 0.9138), (0.2526, 0.4850, 0.7653, -0.3392)),
}


@pytest.mark.parametrize("number", TRUE)
def test_converted_poses_lie_on_the_depth_of_a_real_frame(serve, client, ycb, shared_data, number):
    cv2 = pytest.importorskip("cv2")
    read = cv2.imread(str(shared_data / "images" / "ycbv_000629_depth.png"), cv2.IMREAD_UNCHANGED)
    depth = read.astype(float) * 1e-4
    place, turn = TRUE[number]
    label = f"ycbv-obj_{number:06d}"
    given = [found(label, place=place, turn=Rotation.from_quat(turn).as_matrix())]
    pose = client(serve(lambda *_: given)).estimate(frame(0.0))[LABELS[label]]
    model = ycb[LABELS[label]]
    rotation = Rotation.from_quat(pose.orientation).as_matrix()
    points = model.vertices @ rotation.T + pose.position
    camera = Intrinsics(640, 480, 1066.778, 1067.487, 312.9869, 241.3109)
    pixels = np.round(camera.pixels(points)).astype(int)
    inside = ((pixels >= 0) & (pixels < [640, 480])).all(axis=1)
    points, pixels = points[inside], pixels[inside]
    # the nearest vertex of each patch of 4 × 4 pixels is in front
    order = np.argsort(points[:, 2])
    _, first = np.unique(pixels[order] // 4, axis=0, return_index=True)
    front, at = points[order][first], pixels[order][first]
    measured = depth[at[:, 1], at[:, 0]]
    off = (measured - front[:, 2])[measured > 0]
    assert np.abs(np.median(off)) < 0.006
    assert np.median(np.abs(off)) < 0.008
