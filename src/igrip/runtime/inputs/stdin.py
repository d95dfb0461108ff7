"""Observations from standard input, one line of JSON each."""

from __future__ import annotations

import sys
import threading
from typing import BinaryIO

from igrip.errors import IgripError, ObservationError
from igrip.io import text
from igrip.io.recording_reader import EXAMPLE
from igrip.observation import Observation
from igrip.runtime.inputs import INPUTS
from igrip.runtime.loop import Loop, Sender
from igrip.runtime.options import Options
from igrip.runtime.protocol import MAX_SIZE


@INPUTS.register("stdin")
class StdinInput:
    """Reads standard input in a thread; reading ends with the input or with the process."""

    single_sender = True

    def __init__(self, options: Options) -> None:
        self._frame = options.frame

    def start(self, loop: Loop) -> None:
        """Begin to read."""
        # a file of its own: at exit Python aborts if a thread waits in sys.stdin
        file = open(sys.stdin.fileno(), "rb", closefd=False)  # noqa: SIM115
        sender = Sender(name="standard input", frame=self._frame)
        threading.Thread(target=read_lines, args=(file, loop, sender), daemon=True).start()

    def close(self) -> None:
        """Do nothing."""


def read_lines(file: BinaryIO, loop: Loop, sender: Sender | None = None) -> None:
    """Submit lines until the file ends; malformed ones are counted and skipped.

    Where the run is piped, nothing is dropped, and the run ends with the file; with an error if
    there is nothing in it.
    """
    sender = sender or Sender(name="standard input")
    first, commands = None, 0
    for line in text.read_lines(file, MAX_SIZE + 2):
        try:
            if line.too_long:
                raise ObservationError("message", f"is longer than {MAX_SIZE} bytes")
            message = sender.decode(line.data, f"line {line.number}")
        except ObservationError as error:
            loop.count("malformed")
            first = first or f"line {line.number}: {error}"
            continue
        commands += not isinstance(message, Observation)
        loop.submit(message, sender, wait=loop.piped)
        if loop.piped and sender.refusal is not None:
            return  # the loop ends with an error
    if not loop.piped:
        return
    if sender.accepted or commands:
        loop.finish()
        return
    found = f", {first}. No message can be read" if first else " is empty"
    loop.finish(IgripError(f"standard input{found}; each line must be like {EXAMPLE}"))
