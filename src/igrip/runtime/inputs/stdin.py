"""Observations from standard input, one line of JSON each."""

from __future__ import annotations

import sys
import threading
from typing import BinaryIO

from igrip.errors import ObservationError
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options
from igrip.runtime.protocol import MAX_SIZE, decode


@INPUTS.register("stdin")
class StdinInput:
    """Reads standard input in a thread; reading ends with the input or with the process."""

    single_sender = True

    def __init__(self, options: Options) -> None:
        pass

    def start(self, loop: Loop) -> None:
        """Begin to read."""
        # a file of its own: at exit Python aborts if a thread waits in sys.stdin
        file = open(sys.stdin.fileno(), "rb", closefd=False)  # noqa: SIM115
        threading.Thread(target=read_lines, args=(file, loop), daemon=True).start()

    def close(self) -> None:
        """Do nothing."""


def read_lines(file: BinaryIO, loop: Loop) -> None:
    """Submit lines until the file ends; malformed ones are counted and skipped.

    Where the run is piped, nothing is dropped, and the run ends with the file.
    """
    sender, line_begins = Sender(), True
    while line := file.readline(MAX_SIZE + 2):
        continues, line_begins = not line_begins, line.endswith(b"\n")
        text = line.strip()
        if continues or not text:  # the rest of a line that was too long
            continue
        try:
            loop.submit(decode(text), sender, wait=loop.piped)
        except ObservationError:
            loop.count("malformed")
    if loop.piped:
        loop.finish()
