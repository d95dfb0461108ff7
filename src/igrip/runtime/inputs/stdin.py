"""Observations from standard input, one line of JSON each."""

from __future__ import annotations

import sys
import threading
from typing import BinaryIO

from igrip.errors import ObservationError
from igrip.runtime.connections import Options, Receiver, Sender
from igrip.runtime.inputs import INPUTS
from igrip.runtime.protocol import MAX_SIZE, decode


@INPUTS.register("stdin")
class StdinInput:
    """Reads standard input in a thread."""

    single_sender = True

    def __init__(self, options: Options) -> None:
        self._piped = options.piped

    def start(self, loop: Receiver) -> None:
        """Begin to read."""
        threading.Thread(
            target=read_lines, args=(sys.stdin.buffer, loop, self._piped), daemon=True
        ).start()

    def close(self) -> None:
        """Do nothing: reading ends with the process."""


def read_lines(file: BinaryIO, loop: Receiver, piped: bool) -> None:
    """Submit lines until the file ends; malformed ones are counted and skipped.

    Parameters
    ----------
    file : binary file
        Whose lines are messages.
    loop : Receiver
        Where to.
    piped : bool
        Whether to wait where the loop is behind, rather than drop messages, and to end it with
        the file.
    """
    sender, line_begins = Sender(), True
    while line := file.readline(MAX_SIZE + 2):
        continues, line_begins = not line_begins, line.endswith(b"\n")
        text = line.strip()
        if continues or not text:  # the rest of a line that was too long
            continue
        try:
            loop.submit(decode(text), sender, piped)
        except ObservationError:
            loop.count("malformed")
    if piped:
        loop.finish()
