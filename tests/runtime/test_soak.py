"""Ten minutes at 200 and at 1,000 messages a second through the service, in real time."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
import urllib.request
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from igrip.lab.simulation.demo import DemoConfig, DemoPerson
from memory import resident
from runtime_fakes import PATIENCE, until

SECONDS = float(os.environ.get("IGRIP_SOAK_SECONDS", "600"))
SLACK = 20.0  # ms that a neighbour on the machine may add to the median age


def soak(ycb, seconds, rate):
    """Return what :func:`judge` takes, from a service in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, "-m", "igrip", "stream", "--in", "ws", "--out", "ws", "--port", "0"],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        try:
            address = next(line for line in process.stderr if line.startswith("ws://")).strip()
            return _drive(ycb, process.pid, address, seconds, rate)
        finally:
            process.terminate()
            process.stderr.read()


def _drive(ycb, pid, address, seconds, rate):
    count, part = int(seconds * rate), int(min(60.0, seconds / 4.0) * rate)
    times, memory, ages = {}, {}, {}  # by the number of messages sent
    person = iter(DemoPerson(ycb, 0, DemoConfig(rate=rate)))

    def status():
        with urllib.request.urlopen(f"http{address[2:]}/status", timeout=PATIENCE) as answer:
            return json.load(answer)

    def is_done():
        incoming = status()["incoming"]
        return incoming["received"] == count and incoming["waiting"] == 0

    with connect(f"{address}/observations") as source, connect(f"{address}/intentions") as out:
        threading.Thread(target=drain, args=(out,), daemon=True).start()
        begin = time.monotonic()
        for number in range(count):
            if number in (0, part, count - part):
                times[number], memory[number] = processor_time(pid), resident(pid)
                ages[number] = status()["update"].get("age_p50_ms")
            time.sleep(max(0.0, begin + number / rate - time.monotonic()))
            source.send(next(person).observation.to_json())
        until(is_done)
        times[count], memory[count] = processor_time(pid), resident(pid)
        first = (times[part] - times[0]) / part
        last = (times[count] - times[count - part]) / part
        report = status()
        waited = ages[part], report["update"]["age_p50_ms"]  # of the newest 20,000
        return (first, last), (memory[part], memory[count]), waited, report


def drain(client):
    """Read all that is sent."""
    with contextlib.suppress(ConnectionClosed):
        for _ in client:
            pass


def processor_time(pid):
    """Return how long a process has computed [s]; other processes do not count."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def judge(times, memory, ages, status, count):
    """Check that the end is like the beginning, and that what was lost was counted.

    Parameters
    ----------
    times, memory, ages : 2 floats
        Processor time per message [s], memory [MB], median age of an intention [ms]; early, late.
    """
    print(f"{1e3 * times[0]:.2f} -> {1e3 * times[1]:.2f} ms of processor time per message; "
          f"{memory[0]:.1f} -> {memory[1]:.1f} MB; median age {ages[0]:.1f} -> {ages[1]:.1f} ms; "
          f"{status}")  # fmt: skip
    incoming = status["incoming"]
    assert incoming["received"] == count  # none was lost on the way in, uncounted
    assert status["intentions"] + 2 * incoming.get("dropped", 0) >= 2 * incoming["received"] - 8
    assert times[1] <= 1.5 * times[0]
    assert memory[1] <= memory[0] + 10.0
    assert ages[1] <= 1.5 * ages[0] + SLACK


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="processes are read as on Linux")
@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_ten_minutes_without_a_pause(ycb, rate):
    judge(*soak(ycb, SECONDS, rate), int(SECONDS * rate))
