"""A stand-in for depthai and an OAK: takes the calls igrip makes, and answers as they do."""

import threading
import time
from datetime import timedelta
from types import SimpleNamespace

import numpy as np

WIDTH, HEIGHT = 64, 48
MATRIX = [[50.0, 0, 31.5], [0, 51.0, 23.5], [0, 0, 1]]


class Picture:
    def __init__(self, array, t):
        self.array, self.t = array, t

    def getFrame(self):  # noqa: N802
        return self.array

    def getTransformation(self):  # noqa: N802
        return None

    def getTimestamp(self, offset):  # noqa: N802
        assert offset == "middle"
        return timedelta(seconds=self.t)


class Queue:
    """As depthai's: None after the timeout, an exception when it is closed."""

    def __init__(self):
        self.groups, self.closed = [], threading.Event()

    def get(self, timeout):
        if self.groups:
            return self.groups.pop(0)
        if self.closed.wait(min(timeout.total_seconds(), 0.01)):
            raise RuntimeError("MessageQueue was closed")
        return None


class Node:
    """Takes any call, and remembers it."""

    def __init__(self, kind, calls):
        self.kind, self.calls = kind, calls
        self.inputs = {name: f"{kind}.{name}" for name in ("colour", "depth")}

    def __getattr__(self, name):
        if name.startswith("set") or name in ("link", "build", "requestOutput"):

            def call(*positional, **named):
                self.calls.append((self.kind, name, positional, named))
                return Node(f"{self.kind}.{name}", self.calls)

            return call
        return Node(f"{self.kind}.{name}", self.calls)


class FakeDai:
    def __init__(self, chip="RVC2", stereo=True):
        self.calls, self.queue = [], Queue()
        self.running = True
        self.Platform = SimpleNamespace(RVC2="RVC2", RVC4="RVC4")
        self.CameraBoardSocket = SimpleNamespace(CAM_A="A", CAM_B="B", CAM_C="C")
        self.CameraExposureOffset = SimpleNamespace(MIDDLE="middle")
        self.ImgFrame = SimpleNamespace(Type=SimpleNamespace(RGB888i="rgb"))
        self.Clock = SimpleNamespace(now=lambda: timedelta(seconds=time.monotonic() - 1000.0))
        stereo_node = SimpleNamespace(PresetMode=SimpleNamespace(ROBOTICS="robotics"))
        self.node = SimpleNamespace(
            Camera="camera", StereoDepth=stereo_node, Sync="sync", ImageAlign="align"
        )
        fake = self
        sockets = ["A", "B", "C"] if stereo else ["A"]

        class Device:
            closed = 0

            getAllAvailableDevices = staticmethod(lambda: ["XYZ"])  # noqa: N815

            def __init__(self, *info):
                fake.device = self

            getDeviceId = staticmethod(lambda: "XYZ")  # noqa: N815
            getConnectedCameras = staticmethod(lambda: sockets)  # noqa: N815
            getPlatform = staticmethod(lambda: chip)  # noqa: N815
            readCalibration = staticmethod(  # noqa: N815
                lambda: SimpleNamespace(getCameraIntrinsics=lambda socket, w, h: MATRIX)
            )

            def close(self):
                Device.closed += 1

        class Pipeline:
            def __init__(self, device):
                assert device is fake.device

            def create(self, kind):
                name = kind if isinstance(kind, str) else "stereo"
                node = Node(name, fake.calls)
                if name == "sync":
                    node.out = SimpleNamespace(createOutputQueue=fake.open_queue)
                return node

            def start(self):
                fake.calls.append(("pipeline", "start", (), {}))

            def isRunning(self):  # noqa: N802
                return fake.running

            def stop(self):
                fake.queue.closed.set()

        self.Device, self.Pipeline = Device, Pipeline
        self.DeviceInfo = lambda name: name

    def open_queue(self, maxSize, blocking):
        assert (maxSize, blocking) == (1, False)  # the newest wins
        return self.queue

    def links(self):
        return {(kind, str(to[0] if isinstance(to[0], str) else to[0].kind))
                for kind, name, to, _ in self.calls if name == "link"}  # fmt: skip


def pair(t, k=0, shape=(HEIGHT, WIDTH)):
    return {
        "colour": Picture(np.full((HEIGHT, WIDTH, 3), k, np.uint8), t),
        "depth": Picture(np.full(shape, 700 + k, np.uint16), t),
    }
