"""Inputs and outputs by name."""

from __future__ import annotations

import subprocess
import sys

import pytest

from igrip.errors import UnknownNameError
from igrip.runtime.inputs import INPUTS
from igrip.runtime.outputs import OUTPUTS


def test_names():
    assert INPUTS.names() == ("lsl", "osc", "ros2", "stdin", "ws")
    assert OUTPUTS.names() == ("lsl", "mqtt", "osc", "ros2", "stdout", "udp", "ws")


def test_listing_the_names_imports_no_member():
    script = (
        "import sys\n"
        "from igrip.runtime.inputs import INPUTS\n"
        "from igrip.runtime.outputs import OUTPUTS\n"
        "INPUTS.names(), OUTPUTS.names()\n"
        "peers = ('paho', 'pylsl', 'pythonosc', 'rclpy', 'websockets')\n"
        "print([name for name in sys.modules if name in peers"
        " or name.startswith(('igrip.runtime.inputs.', 'igrip.runtime.outputs.'))])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_an_unknown_name_lists_the_choices():
    with pytest.raises(
        UnknownNameError, match="'pigeon'; there are: lsl, mqtt, osc, ros2, stdout, udp, ws"
    ):
        OUTPUTS.get("pigeon")
