"""``igrip drive`` as a process, watched by the device at the end of its line, killed or cut off."""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from igrip.devices.base.twin import PtyServer
from igrip.devices.twins.serial import SerialTwin
from runtime_fakes import PATIENCE, until

LEASE = {"target": "cup", "grip": "palmar", "since": 1.0, "valid_until": 2.0}


class Drive:
    """The process, its pipe, and a virtual device."""

    def __init__(self, folder: Path, *options: str, text: str = "", armed: bool = True) -> None:
        self.server = PtyServer(SerialTwin(time.monotonic))
        self.twin = self.server.twin
        file = folder / "serial.toml"
        file.write_text(f'port = "{self.server.path}"\nramp = 0.0\n{text}')
        self.process = subprocess.Popen(
            [sys.executable, "-m", "igrip", "drive", "--device", "serial", "--config", file,
             "--from", "stdin", *(["--arm"] if armed else []), *(options or ["--headless"])],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            bufsize=1,
        )  # fmt: skip
        self.lines: list[str] = []
        for line in self.process.stderr:
            self.lines.append(line)
            if "for the right hand" in line:
                break
        assert self.lines, "it did not start"
        threading.Thread(target=self._read_errors, daemon=True).start()
        self.sequence = self.leases = 0

    def _read_errors(self):
        with contextlib.suppress(ValueError):
            self.lines.extend(self.process.stderr)

    def send(self, **changes):
        self.sequence += 1
        message = {
            "session": "a", "seq": self.sequence, "sent": time.monotonic(), "hand": "right",
            "status": "reaching", "target_model": None, "time_to_contact": 0.1,
            "commitment": LEASE, "valid_for": 0.14,
        } | changes  # fmt: skip
        self.leases += message["commitment"] is not None
        self.process.stdin.write(json.dumps(message) + "\n")

    def act(self):
        """Send leases until the device acts."""
        end = time.monotonic() + PATIENCE
        while not self.twin.active:
            assert time.monotonic() < end, "".join(self.lines)
            self.send()
            time.sleep(0.02)

    def close(self):
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            with contextlib.suppress(BrokenPipeError):
                pipe.close()
        self.server.close()


@pytest.fixture
def drive(tmp_path):
    drive = Drive(tmp_path)
    yield drive
    drive.close()


def test_it_acts_while_it_is_allowed_and_stops_in_silence(drive):
    drive.act()
    until(lambda: not drive.twin.active)
    assert drive.twin.outputs[0].text == "grip 1 phase 1 level 255"
    drive.act()  # and again
    drive.send(commitment=None, valid_for=None, status="idle")
    until(lambda: not drive.twin.active)


def test_it_ends_with_its_input(drive):
    drive.act()
    drive.process.stdin.close()
    assert drive.process.wait(PATIENCE) == 0
    assert not drive.twin.active


def test_it_stops_the_device_when_it_is_told_to_end(drive):
    drive.act()
    drive.process.send_signal(signal.SIGTERM)
    assert drive.process.wait(PATIENCE) == 0
    until(lambda: not drive.twin.active)
    assert drive.twin.outputs  # it had acted


def test_without_arm_nothing_leaves(tmp_path):
    drive = Drive(tmp_path, armed=False)
    for _ in range(200):
        drive.send()
        time.sleep(0.005)
        if any("grasp cup palmar" in line for line in drive.lines):
            break
    assert any("grasp cup palmar" in line for line in drive.lines)
    assert drive.twin.outputs == []
    assert drive.twin.accepted == []
    drive.close()


def test_rubbish_on_standard_input_is_counted_and_no_more(drive):
    random.seed(1)
    for _ in range(300):
        noise = "".join(chr(random.randrange(32, 127)) for _ in range(random.randrange(200)))
        drive.process.stdin.write(noise + "\n")
    assert drive.twin.accepted == []
    drive.act()


def test_the_page_shows_and_stops(tmp_path):
    drive = Drive(tmp_path, "--page-port", "0")
    url = next(line for line in drive.lines if line.startswith("page:")).split()[1]

    def status():
        with urllib.request.urlopen(f"{url}/status") as answer:
            return json.load(answer)

    def post(order, **headers):
        request = urllib.request.Request(f"{url}/{order}", method="POST", headers=headers)
        with urllib.request.urlopen(request) as answer:
            return answer.status

    with urllib.request.urlopen(url) as answer:
        assert b"STOP" in answer.read()
    drive.act()
    assert status()["target"] == "cup"
    for headers in ({"Origin": "https://example.com"}, {"Host": "evil.example:80"}):
        with pytest.raises(urllib.error.HTTPError, match="403"):
            post("resume", **headers)
    assert post("stop") == 200
    until(lambda: status()["stopped"])
    starts = status()["counts"]["starts"]
    for _ in range(20):
        drive.send()
        time.sleep(0.01)
    assert not drive.twin.active
    assert status()["counts"]["starts"] == starts
    assert drive.process.stdout.readline() == '{"control":"veto","hand":"right"}\n'
    with pytest.raises(urllib.error.HTTPError, match="404"):
        post("end")
    drive.close()


def kill(drive: Drive, how: str) -> None:
    """Let one thing go wrong while the device acts."""
    if how == "killed":
        drive.process.kill()
    elif how == "hung":
        drive.process.send_signal(signal.SIGSTOP)
    elif how == "pulled":
        drive.server.pulled = True
    elif how == "closed":
        drive.process.stdin.close()
    elif how == "half-open":
        pass  # the sender is still there, and sends no more
    elif how == "old":  # what was sent long ago comes now
        drive.send(sent=time.monotonic() - 10.0)
    elif how == "repeated":
        drive.sequence -= 1
        for _ in range(50):
            drive.sequence -= 1
            drive.send()
    elif how == "cut":  # half a line, then nothing
        os.write(drive.process.stdin.fileno(), b'{"session": "a", "seq": 99999999, "sent": 0, ')


KINDS = ["killed", "hung", "pulled", "closed", "half-open", "old", "repeated", "cut"]


def stops_after(folder: Path, how: str, seed: int) -> bool:
    """Kill something at a random moment of an action; return whether the device stays stopped.

    Nothing may be acted on twice, either.
    """
    random.seed(seed)
    drive = Drive(folder)
    try:
        drive.act()
        for _ in range(random.randrange(10)):
            drive.send()
            time.sleep(random.uniform(0.0, 0.03))
        kill(drive, how)
        until(lambda: not drive.twin.active)
        count = len(drive.twin.accepted)
        time.sleep(0.2)
        stays = not drive.twin.active and len(drive.twin.accepted) == count
        return stays and count <= drive.leases
    finally:
        drive.close()


@pytest.mark.parametrize("how", KINDS)
def test_whatever_goes_wrong_the_device_stops(tmp_path, how):
    assert stops_after(tmp_path, how, seed=1)


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("how", KINDS)
def test_two_hundred_times(tmp_path, how):
    for seed in range(25):
        assert stops_after(tmp_path, how, 100 + seed)
