"""A million damaged messages: the service in its own process, the good client in another."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
import threading
import urllib.request

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from memory import resident
from random_damage import garbled
from runtime_fakes import until

COUNT = int(os.environ.get("IGRIP_FLOOD_MESSAGES", "1000000"))
GOOD = """
import json, sys, time
from websockets.sync.client import connect
with connect(sys.argv[1] + "/observations") as source, connect(sys.argv[1] + "/intentions") as out:
    print("ready", flush=True)
    began, k, own, gaps, last = time.monotonic(), 0, 0, 0, None
    while True:
        t = time.monotonic() - began
        if t >= k / 30.0:
            x = 0.2 + 0.004 * (k % 60)
            hands = {"good": {"position": [x, 0.1, 0.0]}}
            source.send(json.dumps({"t": t, "hands": hands}))
            k += 1
        try:
            message = json.loads(out.recv(timeout=0.005))
        except TimeoutError:
            continue
        if message["hand"] == "good":
            own += message["status"] != "lost"
            gaps += last is not None and message["seq"] < last
            last = message["seq"]
            print(json.dumps([k, own, gaps]), flush=True)
"""


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="memory is read as on Linux")
def test_a_million_damaged_messages():
    service = subprocess.Popen(
        [sys.executable, "-m", "igrip", "stream", "--in", "ws", "--out", "ws", "--port", "0"],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with service:
        try:
            address = next(line for line in service.stderr if line.startswith("ws://")).strip()
            good = subprocess.Popen(
                [sys.executable, "-c", GOOD, address],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            )
            with good:
                try:
                    assert good.stdout.readline().strip() == "ready"
                    newest = [""]

                    def listen():
                        for line in good.stdout:
                            newest[0] = line

                    threading.Thread(target=listen, daemon=True).start()
                    flood(address, 20_000, seed=2)
                    before = resident(service.pid)
                    flood(address, COUNT, seed=3)
                    until(lambda: newest[0] and json.loads(newest[0])[0] > 30)
                    after = resident(service.pid)
                    status = f"http{address[2:]}/status"
                    with urllib.request.urlopen(status) as answer:
                        counts = json.load(answer)["incoming"]
                    assert good.poll() is None, good.stderr.read()  # it was never dropped
                    assert service.poll() is None
                    sent, own, back = json.loads(newest[0])
                finally:
                    good.kill()
        finally:
            service.terminate()
            service.stderr.read()
    print(f"{counts}; the good client sent {sent}, was answered {own}; "
          f"memory {before:.1f} to {after:.1f} MB")  # fmt: skip
    assert counts["malformed"] > 0.3 * COUNT
    assert own > 0.8 * sent
    assert back == 0
    assert after - before < 0.05 * before


def flood(address, count, seed):
    """Send damaged messages as fast as they go."""
    rng, connection = random.Random(seed), None
    for k in range(count):
        if connection is None:
            connection = connect(f"{address}/observations")
            threading.Thread(target=drain, args=(connection,), daemon=True).start()
        hands = {"right": {"position": [0.004 * (k % 100), 0.0, 0.0]}}
        try:
            connection.send(garbled(json.dumps({"t": k / 30.0, "hands": hands}).encode(), rng))
        except ConnectionClosed:  # it may be refused, never crash
            connection = None
    if connection is not None:
        connection.close()


def drain(connection):
    """Read the answers; who does not is closed."""
    try:
        for _ in connection:
            pass
    except ConnectionClosed:
        pass
