"""Devices with joints, through the vendors' packages, against their twins on a terminal."""

from __future__ import annotations

import contextlib
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from igrip.devices import DEVICES
from igrip.devices.base import port as ports
from igrip.devices.base.device import DeviceError, Permit
from igrip.devices.base.posture import Mover
from igrip.devices.base.settings import DeviceFileError, PostureSettings, read_settings
from igrip.devices.base.twin import PtyServer
from igrip.devices.twins.dynamixel import BUS_WATCHDOG, PRESENT_POSITION, TORQUE, crc16
from runtime_fakes import until

for package in ("ah_wrapper", "nml_hand_exo", "dynamixel_sdk"):
    if not any((Path(folder) / package).exists() for folder in sys.path):
        pytest.skip(f"{package} is not installed", allow_module_level=True)

FILES = {
    "ability_hand": """
speed = 400
[grips.palmar]
reach = [20, 20, 20, 20, 20, -80]
grasp = [90, 90, 90, 90, 60, -80]
grasp_wide = [50, 50, 50, 50, 40, -80]
[apertures]
mug = 0.05
""",
    "nml_hand_exo": """
speed = 200
limit_ma = 80
[grips.palmar]
reach = [0, 0, 0, 0, 0]
grasp = [40, 60, 60, 60, 60]
""",
    "dynamixel": """
motors = [1, 2]
rest = [10, 10]
speed = 400
[grips.palmar]
reach = [10, 20]
grasp = [60, 70]
""",
}


def settings_of(name, tmp_path, port="twin", **changes):
    file = tmp_path / f"{name}.toml"
    file.write_text(FILES[name])
    return read_settings(DEVICES.get(name).Settings, file, port=port, **changes)


class Rig:
    def __init__(self, name, tmp_path, **changes):
        self.name, kind = name, DEVICES.get(name)
        settings = settings_of(name, tmp_path, **changes)
        self.server = PtyServer(kind.new_twin(settings, time.monotonic))
        self.twin = self.server.twin
        self.device = kind(settings_of(name, tmp_path, self.server.path, **changes), time.monotonic)
        self.device.open()
        self.number = 0

    def allow(self, phase="grasp", model=None):
        self.number += 1
        end = time.monotonic() + 5.0  # a busy machine must not end the permit
        self.device.allow(Permit(self.number, "right", "cup", "palmar", model, phase, end))

    def close_fully(self, model=None):
        for _ in range(100):
            self.allow(model=model)
            time.sleep(0.02)
            if self.device.state().condition == "holding":
                return
        raise AssertionError("it never held")

    def close(self):
        self.server.pulled = False
        with contextlib.suppress(DeviceError):
            self.device.close()
        self.server.close()


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 1.0)
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 500)  # ms; its half


@pytest.fixture(params=sorted(FILES))
def rig(request, tmp_path):
    rig = Rig(request.param, tmp_path)
    yield rig
    rig.close()


def posture(rig):
    if rig.name == "ability_hand":
        return list(rig.twin.positions)
    if rig.name == "nml_hand_exo":
        return [rig.twin.firmware.angles[motor] for motor in (15, 16, 17, 18, 19)]
    return [rig.twin._value(motor, PRESENT_POSITION, 4) / 4096 * 360 for motor in (1, 2)]


def test_the_posture_of_the_file_is_reached(rig, tmp_path):
    goal = settings_of(rig.name, tmp_path).goal("palmar", "grasp", None)
    rig.close_fully()
    until(lambda: rig.allow() or posture(rig) == pytest.approx(goal, abs=1.0))


def test_it_stops_when_it_is_told(rig):
    rig.allow()
    until(lambda: rig.allow() or rig.twin.active)
    rig.device.stop("veto")
    until(lambda: not rig.twin.active)
    before = posture(rig)
    time.sleep(0.3)
    assert posture(rig) == pytest.approx(before, abs=2.0)


def test_what_it_holds_is_kept_in_silence(rig):
    rig.close_fully()
    before = posture(rig)
    rig.device.stop("silence")
    time.sleep(0.3)
    assert rig.device.state().condition == "holding"
    for now, then in zip(posture(rig), before, strict=True):
        assert abs(now) >= abs(then) - 1.0


def test_at_the_end_it_opens(rig):
    rig.close_fully()
    rig.device.stop("end")
    assert rig.device.state().condition == "open"
    if rig.name == "ability_hand":
        until(lambda: max(rig.twin.positions) < 12.0)
    else:
        until(lambda: not rig.twin.active)


def test_rubbish_is_an_error_at_most(rig, monkeypatch):
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 0.02)
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 10)
    random.seed(4)
    answer = rig.twin.receive
    for _ in range(25):
        noise = random.randbytes(random.randrange(1, 80))
        rig.twin.receive = lambda data, noise=noise: (answer(data), noise)[1]
        for act in (rig.allow, rig.device.stop, rig.device.state):
            with contextlib.suppress(DeviceError):
                act()
    rig.twin.receive = answer
    monkeypatch.setattr(ports, "ANSWER_TIMEOUT", 1.0)
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 500)
    time.sleep(0.2)
    for _ in range(3):  # what is left of the rubbish may spoil one answer
        try:
            rig.device.stop("veto")
            break
        except DeviceError:
            time.sleep(0.1)
    until(lambda: not rig.twin.active)
    rig.close_fully()  # and it acts as before
    assert rig.twin.active


def test_a_hand_that_is_not_there(tmp_path, rig):
    kind = DEVICES.get(rig.name)
    with pytest.raises(DeviceError):
        kind(settings_of(rig.name, tmp_path, "/dev/ttyNONE"), time.monotonic).open()


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("ability_hand", ("speed = 400", "speed = 4000")),
        ("ability_hand", ("[90, 90", "[120, 90")),
        ("ability_hand", ("speed = 400", "max_current = 3")),
        ("nml_hand_exo", ("limit_ma = 80", "limit_ma = 401")),
        ("dynamixel", ("speed = 400", "limit_ma = 1e6")),
        ("dynamixel", ("[60, 70]", "[60, 361]")),
        ("dynamixel", ("[60, 70]", "[60, 70, 80]")),
    ],
)
def test_no_file_is_beyond_the_limits_of_the_code(tmp_path, name, change):
    file = tmp_path / "device.toml"
    file.write_text(FILES[name].replace(*change))
    with pytest.raises(DeviceFileError):
        read_settings(DEVICES.get(name).Settings, file)


def test_currents_of_motors_are_bounded(tmp_path):
    for name, limit in (("nml_hand_exo", 80.0), ("dynamixel", 150.0)):
        rig = Rig(name, tmp_path)
        rig.close_fully()
        strongest = max(output.current for output in rig.twin.outputs)
        assert 0.9 * limit < strongest <= limit
        rig.close()


def test_a_motor_that_draws_too_much_stops_the_hand(tmp_path):
    rig = Rig("ability_hand", tmp_path)
    rig.twin.current = 1.5
    with pytest.raises(DeviceError, match="draws"):
        until(lambda: rig.allow() or time.sleep(0.02))
    rig.close()


def test_the_wider_the_object_the_wider_the_grasp(tmp_path):
    settings = settings_of("ability_hand", tmp_path)
    narrow, wide = (settings.goal("palmar", "grasp", model) for model in ("pen", "mug"))
    assert narrow == (90, 90, 90, 90, 60, -80)
    assert wide == (70, 70, 70, 70, 50, -80)


def test_dynamixels_stop_by_themselves(tmp_path):
    rig = Rig("dynamixel", tmp_path, speed=20)
    rig.allow()
    assert {table[BUS_WATCHDOG] for table in rig.twin.tables.values()} <= {7, 255}
    until(lambda: {table[BUS_WATCHDOG] for table in rig.twin.tables.values()} == {255})
    assert not rig.twin.active
    rig.device.stop()
    rig.allow()  # and they can be used again
    until(lambda: {table[TORQUE] for table in rig.twin.tables.values()} == {1})
    rig.close()


def test_the_twins_crc_is_that_of_the_library():
    import dynamixel_sdk

    random.seed(1)
    for _ in range(200):
        data = random.randbytes(random.randrange(1, 60))
        library = dynamixel_sdk.Protocol2PacketHandler().updateCRC(0, data, len(data))
        assert crc16(data) == library


def test_the_mover_is_never_faster_than_it_says():
    random.seed(3)
    mover, t = Mover((0.0, 0.0), 50.0), 0.0
    for _ in range(2000):
        step = random.choice((0.001, 0.03, 0.2, 5.0))
        before, t = mover.positions, t + step
        after = mover.step((random.uniform(0, 90), random.uniform(0, 90)), t)
        most = 50.0 * max(0.02, min(step, 0.1)) + 1e-9
        assert max(abs(a - b) for a, b in zip(after, before, strict=True)) <= most


def test_the_ability_hand_leaves_no_files(tmp_path):
    (tmp_path / "config.py").write_text("raise SystemExit('run')")
    code = (
        "from igrip.devices.ability_hand import _library; _library(); import os; print(os.getcwd())"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(tmp_path)
    assert [path.name for path in tmp_path.iterdir() if path.suffix != ".pyc"] == ["config.py"]


def test_settings_of_postures_agree():
    with pytest.raises(ValueError, match="needs 2"):
        PostureSettings(rest=(0, 0), grips={"palmar": {"reach": (0, 0), "grasp": (1,)}})
