"""RehaStim 2 and P24, through the vendors' libraries, against their twins on a terminal."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time

import pytest

from igrip.devices import DEVICES
from igrip.devices.base import port as ports
from igrip.devices.base.device import DeviceError, Permit
from igrip.devices.base.gate import Gate
from igrip.devices.base.limits import MAX_CURRENT
from igrip.devices.base.sciencemode import largest2, largest4
from igrip.devices.base.settings import DeviceFileError, StimulatorSettings, read_settings
from igrip.devices.base.stimulator import CurrentRamp, Pulse
from igrip.devices.base.twin import PtyServer
from runtime_fakes import until

pytest.importorskip("pysciencemode")
pytest.importorskip("science_mode_4")

NAMES = ["rehastim2", "p24"]
PATTERNS = """
limit_ma = 20
ramp = 0.05
[grips.palmar]
reach = [{number = 2, current_ma = 8, width_us = 200, muscle = "extensor digitorum"}]
grasp = [
    {number = 1, current_ma = 15, width_us = 300, muscle = "flexor digitorum superficialis"},
    {number = 4, current_ma = 12.5, width_us = 240, muscle = "thenar"},
]
"""


def settings_of(tmp_path, **changes):
    file = tmp_path / "device.toml"
    file.write_text(PATTERNS)
    return read_settings(StimulatorSettings, file, **changes)


def permit(number, phase="grasp", ttl=0.12):
    return Permit(number, "right", "cup", "palmar", None, phase, time.monotonic() + ttl)


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    """A busy machine must not look like a stimulator that does not answer."""
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 1.0)


@pytest.fixture(params=NAMES)
def rig(request, tmp_path):
    kind = DEVICES.get(request.param)
    server = PtyServer(kind.new_twin(None, time.monotonic))
    device = kind(settings_of(tmp_path, port=server.path), time.monotonic)
    device.open()
    yield device, server
    server.pulled = False
    with contextlib.suppress(DeviceError):
        device.close()
    server.close()


def close_fully(device):
    for number in range(8):
        device.allow(permit(number))
        time.sleep(0.02)


def test_the_pattern_of_the_file_reaches_the_skin(rig):
    device, server = rig
    close_fully(device)
    given = {(channel, width) for channel, current, width in server.twin.pulses if current > 0}
    assert given == {(1, 300), (4, 240)}
    currents = {channel: current for channel, current, _ in server.twin.pulses if current > 0}
    assert currents[1] == 15.0
    assert currents[4] in (12.0, 12.5)  # rounded down where it takes whole ones
    assert device.state().condition == "holding"
    device.stop()
    assert not server.twin.active
    assert device.state().condition == "open"
    device.allow(permit(9, "reach"))
    assert [c for c, i, _ in server.twin.pulses if i > 0] == [2]


def test_only_the_main_thread_is_needed(rig):
    """No thread of a library keeps a stimulation alive."""
    device, _ = rig
    close_fully(device)
    names = {thread.name for thread in threading.enumerate()}
    assert [name for name in names if "watchdog" in name or "catch" in name] == []


def test_its_own_watchdog_ends_what_nobody_renews(rig):
    device, server = rig
    close_fully(device)
    time.sleep(1.0)
    assert server.twin.active  # the stimulator itself waits for 2 s
    until(lambda: not server.twin.active)


def test_a_pulled_cable_is_an_error_within_a_bounded_time(rig):
    device, server = rig
    close_fully(device)
    server.pulled = True
    begin = time.monotonic()
    with pytest.raises(DeviceError):
        device.allow(permit(20))
    with pytest.raises(DeviceError):
        device.stop()
    assert time.monotonic() - begin < 5.0


def test_rubbish_from_the_stimulator_is_an_error_and_no_hang(rig, monkeypatch):
    device, server = rig
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 0.05)
    random.seed(5)
    answer = server.twin.receive
    broken = 0
    for number in range(60):
        noise = random.randbytes(random.randrange(1, 60))
        cut = random.random() < 0.5
        server.twin.receive = lambda data, noise=noise, cut=cut: (
            noise if cut else noise + answer(data)
        )
        try:
            device.allow(permit(number))
        except DeviceError:
            broken += 1
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 1.0)
    server.twin.receive = answer
    assert broken
    device.stop()
    assert not server.twin.active


@pytest.mark.parametrize("current", [20.5, 41, -1, "nan", "inf", 1e9])
def test_no_file_is_beyond_the_limit(tmp_path, current):
    file = tmp_path / "device.toml"
    file.write_text(PATTERNS.replace("current_ma = 15", f"current_ma = {current}"))
    with pytest.raises(DeviceFileError, match="palmar"):
        read_settings(StimulatorSettings, file)


@pytest.mark.parametrize("limit", [MAX_CURRENT + 0.5, 1e9, "inf", "nan"])
def test_no_file_raises_the_limit_of_the_code(tmp_path, limit):
    file = tmp_path / "device.toml"
    file.write_text(PATTERNS.replace("limit_ma = 20", f"limit_ma = {limit}"))
    with pytest.raises(DeviceFileError, match="limit_ma"):
        read_settings(StimulatorSettings, file)


def test_no_command_is_beyond_the_limit_whoever_gives_it(rig):
    """Behind all checks, the bytes are looked at before they leave."""
    device, server = rig
    close_fully(device)
    for current in (21.0, 60.0, 127.0):
        with pytest.raises(DeviceError, match=r"above the limit|refused"):
            device._stimulate([Pulse(1, current, 300), Pulse(4, current, 240)])
    assert max(output.current for output in server.twin.outputs) <= 20.0
    with pytest.raises(DeviceError, match="width"):
        device._stimulate([Pulse(1, 5.0, 450), Pulse(4, 5.0, 450)])


@pytest.mark.parametrize("largest", [largest2, largest4])
def test_the_gate_bears_any_bytes(largest):
    random.seed(7)

    class Port:
        def write(self, data):
            return len(data)

    gate = Gate(Port(), largest, 20.0, 400.0)
    for _ in range(3000):
        data = b"\xf0" + random.randbytes(random.randrange(40)) + b"\x0f"
        assert gate.write(data) == len(data)


def test_the_ramp_is_never_steeper_than_it_says():
    random.seed(3)
    ramp, before, t = CurrentRamp(20.0, 0.5), {}, 0.0
    for _ in range(2000):
        step = random.choice((0.001, 0.03, 3.0))
        t += step
        goals = {k: random.uniform(0, 20) for k in random.sample(range(1, 9), 3)}
        now = ramp.step(goals, t)
        for channel, current in now.items():
            rise = current - before.get(channel, 0.0)
            assert rise <= 20.0 / 0.5 * max(min(step, 0.1), 0.02) + 1e-9
            assert current <= goals[channel]
        before = now


CHILD = """
import sys, time
sys.path[:0] = sys.argv[3:]
from pathlib import Path
from igrip.devices import DEVICES
from igrip.devices.base import port as ports
ports.ANSWER_TIMEOUT = 1.0
from igrip.devices.base.device import Permit
from igrip.devices.base.settings import StimulatorSettings, read_settings
kind = DEVICES.get(sys.argv[1])
device = kind(read_settings(StimulatorSettings, Path(sys.argv[2])), time.monotonic)
device.open()
for number in range(1000000):
    device.allow(Permit(number, "right", "cup", "palmar", None, "grasp", time.monotonic() + 0.12))
    if number == 5:
        print("acts", flush=True)
    time.sleep(0.03)
"""


@pytest.mark.parametrize("name", NAMES)
def test_a_killed_process_has_last_words(tmp_path, name):
    kind = DEVICES.get(name)
    server = PtyServer(kind.new_twin(None, time.monotonic))
    file = tmp_path / "device.toml"
    file.write_text(f'port = "{server.path}"\n{PATTERNS}')
    child = subprocess.Popen(
        [sys.executable, "-c", CHILD, name, file, *sys.path], stdout=subprocess.PIPE, text=True
    )
    try:
        assert child.stdout.readline() == "acts\n"
        assert server.twin.active
        os.kill(child.pid, signal.SIGKILL)
        killed = time.monotonic()
        until(lambda: not server.twin.active)
        # its own watchdog would have come after 2 s of the newest command
        assert server.twin.outputs[-1].t - killed < 1.9
    finally:
        child.kill()
        child.wait()
        child.stdout.close()
        server.close()
