"""Observations from standard input, a line of JSON each."""

from __future__ import annotations

from typing import BinaryIO

from igrip.errors import ObservationError
from igrip.runtime.protocol import LARGEST, decode
from igrip.runtime.service import Service


def read_lines(file: BinaryIO, service: Service, wait: bool, alone: bool) -> None:
    """Take lines until there are no more; malformed ones are counted and left out.

    Parameters
    ----------
    file : binary file
        Whose lines are messages.
    service : Service
        That takes them.
    wait : bool
        Whether to wait where the estimator is behind (a recording), rather than lose old ones.
    alone : bool
        Whether the service ends with the input.
    """
    whole = True
    while line := file.readline(LARGEST + 2):
        ends, began = line.endswith(b"\n"), whole
        whole = ends
        if not began:  # the rest of a line that was too long
            continue
        text = line.strip()
        if not text:
            continue
        try:
            service.take(decode(text), "stdin", wait)
        except ObservationError:
            service.inbox.count("malformed")
    if alone:
        service.inbox.close()
