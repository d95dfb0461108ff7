"""How every command ends: one line for what went wrong, and its exit code."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NoReturn, TextIO

import typer

from igrip.errors import IgripError

DONE, WRONG, INTERRUPTED = 0, 2, 130
NOTHING_KEPT = "nothing was written"
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]  # typer brings a click of its own


def end(command: Callable[[], object]) -> NoReturn:
    """Run a command, print what went wrong in one line, and exit.

    Exit codes: 0 done, or the reader of the output closed it; 1 done but something failed; 2 wrong
    input, or an output that cannot be written; 130 ended by Ctrl-C.
    """
    try:
        command()
        sys.stdout.flush()  # a reader may have gone, or a disk may be full
        code = DONE
    except typer.Exit as exit:
        code = exit.exit_code
    except BrokenPipeError:  # the reader of our output closed it, which is no error
        code = DONE
    except KeyboardInterrupt as interrupt:
        ignore_interrupts()  # a second one would cut the line off
        _print(f"stopped; {str(interrupt) or NOTHING_KEPT}")
        code = INTERRUPTED
    except Exception as error:
        text = line_of(error)
        if text is None:
            raise
        _print(text)
        code = WRONG
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError, AttributeError):
            _discard(stream)
    sys.exit(code)


def line_of(error: Exception) -> str | None:
    """Return what to print for an error in place of a traceback; None for a bug."""
    if isinstance(error, IgripError):
        return str(error)
    if isinstance(error, USAGE_ERROR):
        return _usage(error)
    if isinstance(error, OSError):
        reason = error.strerror or str(error)
        return reason if error.filename is None else f"{error.filename}: {reason}"
    if "pydantic" in sys.modules:
        from pydantic import ValidationError

        if isinstance(error, ValidationError):
            return "; ".join(
                ": ".join(filter(None, (error.title, ".".join(map(str, one["loc"])), one["msg"])))
                for one in error.errors()
            )
    return None


def _usage(error: Any) -> str:
    """Return what is wrong with the arguments, and where the valid ones are listed."""
    context = error.ctx
    if type(error).__name__ == "NoArgsIsHelpError":
        return str(error.format_message())
    command = "igrip" if context is None else context.command_path
    text = str(error.format_message()).replace("Value error, ", "").rstrip(".")
    return f"{text}{' ' if text.endswith('?') else '; '}see: {command} --help"


def _print(text: str) -> None:
    from igrip.cli.console import errors

    with suppress(OSError):
        errors.print(f"igrip: {text}", style="red", soft_wrap=True)


def _discard(stream: TextIO) -> None:
    """Let the interpreter's last flush succeed where nobody reads a stream any more."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def ignore_interrupts() -> None:
    """Ignore Ctrl-C from now on."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
