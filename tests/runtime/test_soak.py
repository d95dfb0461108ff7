"""Ten minutes at 200 messages a second through the service, in real time."""

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
RATE = 200.0


def soak(ycb, seconds, rate=RATE):
    """Return seconds of processor time per message, and memory [MB], early and late; status."""
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
    times, memory = {}, {}  # by the number of messages sent
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
            time.sleep(max(0.0, begin + number / rate - time.monotonic()))
            source.send(next(person).observation.to_json())
        until(is_done)
        times[count], memory[count] = processor_time(pid), resident(pid)
        first = (times[part] - times[0]) / part
        last = (times[count] - times[count - part]) / part
        return first, last, memory[part], memory[count], status()


def drain(client):
    """Read all that is sent."""
    with contextlib.suppress(ConnectionClosed):
        for _ in client:
            pass


def processor_time(pid):
    """Return how long a process has computed [s]; other processes do not count."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def judge(first, last, early, late, status, seconds):
    print(f"{1e3 * first:.2f} -> {1e3 * last:.2f} ms per message; {early:.1f} -> {late:.1f} MB; "
          f"{status}")  # fmt: skip
    incoming = status["incoming"]
    assert incoming["received"] == int(seconds * RATE)  # none was lost on the way in, uncounted
    assert status["intentions"] + 2 * incoming.get("dropped", 0) >= 2 * incoming["received"] - 8
    assert last <= 1.5 * first
    assert late <= early + 10.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="processes are read as on Linux")
def test_ten_minutes_at_200_messages_a_second(ycb):
    judge(*soak(ycb, SECONDS), SECONDS)
