"""The serial device on a pseudo-terminal: against its twin, and against the C of the examples."""

from __future__ import annotations

import itertools
import os
import random
import re
import shutil
import subprocess
import time
import tty
from pathlib import Path

import pytest

from igrip.devices.base.device import DeviceError, Permit
from igrip.devices.base.frames import ALLOW, HELLO, STOP, Allow, Frame
from igrip.devices.base.settings import DeviceFileError, read_settings
from igrip.devices.base.twin import PtyServer
from igrip.devices.serial import SerialDevice, SerialSettings
from igrip.devices.twins.serial import SerialTwin
from runtime_fakes import Clock, until

EXAMPLE = Path(__file__).parents[2] / "examples" / "serial_device"
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc (make system)")


def permit(number, clock, phase="grasp", ttl=0.12):
    return Permit(number, "right", "cup", "palmar", None, phase, clock() + ttl)


@pytest.fixture
def twin():
    server = PtyServer(SerialTwin(time.monotonic))
    yield server
    server.close()


def test_over_a_terminal(twin):
    device = SerialDevice(SerialSettings(port=twin.path, ramp=0.0), time.monotonic)
    device.open()
    until(lambda: device.state().detail == "level 0")
    device.allow(permit(1, time.monotonic))
    until(lambda: device.state().condition == "closing")
    device.stop()
    until(lambda: device.state().condition == "open")
    assert twin.twin.outputs[0].text == "grip 1 phase 1 level 255"
    with pytest.raises(DeviceError):
        SerialDevice(SerialSettings(port=twin.path), time.monotonic).open()  # it is taken
    device.close()


def test_a_port_that_is_not_there():
    with pytest.raises(DeviceError, match="ttyNONE"):
        SerialDevice(SerialSettings(port="/dev/ttyNONE"), time.monotonic).open()


def test_a_permit_that_has_ended_sends_nothing():
    clock = Clock(1.0)
    twin = SerialTwin(clock)

    class Line:
        def write(self, data):
            twin.receive(data)

        def read(self, size):
            return b""

    device = SerialDevice(SerialSettings(), clock, Line())
    device.open()
    device.allow(permit(1, clock, ttl=0.0))
    assert not twin.active


def test_a_level_above_the_limit_is_refused_in_the_file(tmp_path):
    file = tmp_path / "device.toml"
    file.write_text("max_level = 100\n[grips.palmar]\nnumber = 1\ngrasp = 101\n")
    with pytest.raises(DeviceFileError, match="palmar"):
        read_settings(SerialSettings, file)


def test_the_level_rises_no_faster_than_the_ramp():
    clock = Clock(1.0)
    twin = SerialTwin(clock)

    class Line:
        def write(self, data):
            twin.receive(data)

        def read(self, size):
            return b""

    device = SerialDevice(SerialSettings(ramp=0.5), clock, Line())
    device.open()
    levels = []
    for number in range(40):
        device.allow(permit(number, clock))
        levels.append((clock.t, int(twin.outputs[-1].text.split()[-1])))
        clock.t += 0.02
        device._heard = clock.t
    for (t0, a), (t1, b) in itertools.pairwise(levels):
        assert b - a <= 255 * (t1 - t0) / 0.5 + 1
    assert levels[-1][1] == 255


class Board:
    """The compiled example at the other end of a pseudo-terminal."""

    def __init__(self, program):
        self.main, side = os.openpty()
        tty.setraw(side)
        self.path = os.ttyname(side)
        self.process = subprocess.Popen(
            [program, self.path], stdout=subprocess.PIPE, text=True, bufsize=1
        )
        assert self.line().endswith("ready")
        os.close(side)

    def line(self):
        return self.process.stdout.readline().strip()

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        os.close(self.main)


@pytest.fixture(scope="session")
def program(tmp_path_factory):
    target = tmp_path_factory.mktemp("board") / "board"
    subprocess.run(
        ["gcc", "-std=c99", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror", "-O2",
         "-o", target, EXAMPLE / "pty_main.c"], check=True,
    )  # fmt: skip
    return str(target)


@pytest.fixture
def board(program):
    board = Board(program)
    yield board
    board.close()


@needs_gcc
def test_the_example_in_c_acts_and_stops_by_itself(board):
    os.write(board.main, Frame(1, ALLOW, Allow(60000, 2, 1, 77).pack()).encode())
    begin, *action = board.line().split()
    assert action == ["act", "2", "1", "77"]
    end, word = board.line().split()  # nobody told it to
    assert word == "rest"
    assert int(end) - int(begin) >= 150
    assert os.read(board.main, 64)[0] == 0xA5


@needs_gcc
def test_the_example_in_c_does_what_the_twin_does(board):
    """The same noisy bytes, frame by frame, to both."""
    random.seed(3)
    clock = Clock(0.0)
    twin = SerialTwin(clock)
    expected, sequence = [], 0
    allow = twin._allow
    twin._allow = lambda what, number: (expected.append(tuple(what[1:])), allow(what, number))
    for _ in range(400):
        sequence = (sequence + random.choice((0, 1, 1, 1, 2, 200))) & 255
        kind = random.choice((ALLOW, ALLOW, ALLOW, STOP))
        payload = Allow(150, random.randrange(4), random.randrange(2), random.randrange(256))
        data = bytearray(Frame(sequence, kind, payload.pack() if kind == ALLOW else b"").encode())
        if random.random() < 0.2:
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
        data = random.randbytes(random.randrange(4)) + bytes(data)
        twin.receive(data)
        os.write(board.main, data)
        while os.get_blocking(board.main) and _readable(board.main):
            os.read(board.main, 4096)
    last = b"\0" * 40 + Frame(0, HELLO).encode()
    last += Frame(1, ALLOW, Allow(150, 9, 0, 0).pack()).encode()
    os.write(board.main, last)
    twin.receive(last)
    done = []
    while not done or done[-1][0] != 9:
        found = re.search(r"act (\d+) (\d+) (\d+)", board.line())
        if found:
            done.append(tuple(map(int, found.groups())))
    assert done == expected
    assert len(done) > 50


def _readable(descriptor):
    import select

    return bool(select.select([descriptor], [], [], 0.0)[0])
