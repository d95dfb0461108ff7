"""Ten minutes at 200 messages a second through the service, on the clock on the wall."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
import urllib.request

import numpy as np
import pytest
from websockets.sync.client import connect

from igrip.lab.simulation.demo import DemoConfig, DemoPerson
from memory import resident

SECONDS = float(os.environ.get("IGRIP_SOAK_SECONDS", "600"))
RATE = 200.0


def soak(ycb, seconds, rate=RATE):
    """Return p50 of the first and last part [s], memory [MB] early and at the end, and status."""
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
    latencies, stop = [], threading.Event()
    part = min(60.0, seconds / 4.0)
    person = iter(DemoPerson(ycb, 0, DemoConfig(rate=rate)))
    with connect(f"{address}/observations") as source, connect(f"{address}/intentions") as out:

        def listen():
            while not stop.is_set():
                try:
                    said = json.loads(out.recv(timeout=0.5))
                except TimeoutError:
                    continue
                latencies.append((time.monotonic(), said["age"]))

        listening = threading.Thread(target=listen, daemon=True)
        listening.start()
        begin, early = time.monotonic(), None
        for number in range(int(seconds * rate)):
            wait = begin + number / rate - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            source.send(next(person).observation.to_json())
            if early is None and time.monotonic() - begin > part:
                early = resident(pid)
        end = time.monotonic()
        time.sleep(1.5)
        with urllib.request.urlopen(f"http{address[2:]}/status", timeout=5) as answer:
            status = json.load(answer)
        late = resident(pid)
        stop.set()
        listening.join()
    first = np.median([age for t, age in latencies if t < begin + part])
    last = np.median([age for t, age in latencies if t > end - part])
    return first, last, early, late, status


def judged(first, last, early, late, status, seconds):
    print(f"p50 {1e3 * first:.2f} -> {1e3 * last:.2f} ms; {early:.1f} -> {late:.1f} MB; {status}")
    incoming = status["incoming"]
    answered = status["intentions"]
    assert incoming["waiting"] == 0
    assert incoming["received"] == int(seconds * RATE)  # none was lost on the way in, uncounted
    assert answered + 2 * incoming.get("dropped", 0) >= 2 * incoming["received"] - 8
    assert last <= 1.5 * first
    assert late <= early + 10.0


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_ten_minutes_at_200_messages_a_second(ycb):
    judged(*soak(ycb, SECONDS), SECONDS)
