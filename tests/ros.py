"""Nodes of ROS 2 on this machine alone."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

from runtime_fakes import PATIENCE

needs_ros = pytest.mark.skipif(
    find_spec("rclpy") is None, reason="needs rclpy: pip install 'igrip[ros]'"
)


@pytest.fixture
def domain(monkeypatch):
    """Keep discovery on this machine, and apart from other tests."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))


@contextmanager
def peer(*arguments):
    """Run a node in a process of its own; yield a function that returns what it says next."""
    process = subprocess.Popen(
        [sys.executable, Path(__file__).with_name("ros_peer.py"), *arguments],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    said = queue.Queue()
    passed_over = []  # what it said under other keys: topics overtake each other

    def read():
        for line in process.stdout:
            said.put(json.loads(line))

    thread = threading.Thread(target=read, daemon=True)
    thread.start()

    def hear(key, wait=None):
        """Return the next value of a key; None if it must not be waited for and is not there."""
        for k, one in enumerate(passed_over):
            if key in one:
                return passed_over.pop(k)[key]
        while True:
            try:
                one = said.get(timeout=wait or PATIENCE)
            except queue.Empty:
                if wait is None:
                    raise
                return None
            if key in one:
                return one[key]
            passed_over.append(one)

    try:
        hear("ready")
        yield hear
    finally:
        process.stdin.close()
        process.wait(timeout=PATIENCE)
        thread.join(timeout=PATIENCE)
        process.stdout.close()
