"""Log lines: igrip's own warnings are printed once, those of other libraries do not bury them."""

from __future__ import annotations

import logging
import os
import sys

VERBOSE = "IGRIP_VERBOSE"


class LinePrinter(logging.Handler):
    """Print messages of the library as those of the commands, each once."""

    def __init__(self, level: int = logging.WARNING) -> None:
        super().__init__(level)
        self._printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Print one message."""
        from igrip.cli.console import inform, warn

        text = record.getMessage()
        if text not in self._printed:
            self._printed.add(text)
            (warn if record.levelno >= logging.WARNING else inform)(text)


def print_own() -> None:
    """Print what igrip's packages log and no command prints itself."""
    own = logging.getLogger("igrip")
    if not own.handlers:
        own.addHandler(logging.NullHandler())  # the commands print their own
        logging.getLogger("igrip.objects").addHandler(LinePrinter())
        compiling = logging.getLogger("igrip.compiled")
        compiling.setLevel(logging.INFO)
        compiling.addHandler(LinePrinter(logging.INFO))


def keep_apart() -> None:
    """Keep the log lines of other libraries off standard error, unless IGRIP_VERBOSE is set.

    Libraries in C and C++ (MediaPipe, liblsl, depthai) write to the file descriptor itself, so
    igrip's own lines go to a copy of it, and what arrives at the original is discarded. What a
    library reports as an exception is printed as before.
    """
    if os.environ.get(VERBOSE) or sys.stderr is not sys.__stderr__:
        return
    own = sys.stderr
    if own is None:  # a program without a terminal
        return
    logging.captureWarnings(True)
    logging.getLogger().addHandler(logging.NullHandler())  # in place of the handler of last resort
    own.flush()
    sys.stderr = open(  # noqa: SIM115 - as long as the process
        os.dup(2), "w", encoding=own.encoding, errors="backslashreplace", buffering=1
    )
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    os.close(nowhere)
