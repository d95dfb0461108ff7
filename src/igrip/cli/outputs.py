"""Files, folders and ports that a command will need, tried before anything slow begins."""

from __future__ import annotations

import errno
import os
import socket
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from igrip.errors import IgripError


class OutputError(IgripError):
    """A file, folder or port that a command cannot use."""


def check_file(path: Path, endings: Sequence[str] = ()) -> Path:
    """Return the path of a file that can be written; nothing is left behind, or changed.

    Raises
    ------
    OutputError
        If it cannot be written, or has none of the endings.
    """
    if endings and path.suffix.lower() not in endings:
        raise OutputError(f"{path}: the ending must be {any_of(endings)}")
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; name a file")
    try:
        if path.is_file():
            path.open("ab").close()
        elif not path.exists():  # a device or a pipe is what it is
            _try_folder(path.parent)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {_reason(error, path.parent)}") from error
    return path


def check_folder(path: Path, new: bool = False) -> Path:
    """Return the path of a folder that can be written, or made; nothing is left behind.

    Raises
    ------
    OutputError
        If it cannot be, or if it must be ``new`` and holds something.
    """
    try:
        if path.exists() and (not path.is_dir() or (new and any(path.iterdir()))):
            what = "exists already" if new else "is a file"
            raise OutputError(f"{path}: {what}; name a {'new ' if new else ''}folder")
        nearest = next(p for p in (path, *path.absolute().parents) if p.exists())
        _try_folder(nearest)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {_reason(error, path.parent)}") from error
    return path


def free_port(port: int, option: str = "--port", host: str = "127.0.0.1", udp: bool = False) -> int:
    """Return a port that nobody listens on: the one that is given, or any for 0.

    Raises
    ------
    OutputError
        If it is in use, or the host is none of this machine.
    """
    kind = socket.SOCK_DGRAM if udp else socket.SOCK_STREAM
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=kind)[0]
        with socket.socket(family, kind) as trial:
            if not udp and os.name == "posix":  # as servers do: one that has just ended is no other
                trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(address)
            return int(trial.getsockname()[1])
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise OutputError(
                f"port {port} is in use, perhaps by another igrip: name another with {option}, "
                f"or {option} 0 for any that is free"
            ) from error
        reason = error.strerror or error
        raise OutputError(f"cannot listen on {host}:{port}: {reason}") from error


def file_option(*endings: str) -> Callable[[Path | None], Path | None]:
    """Return the callback of an option that names a file to write."""

    def check(value: Path | None) -> Path | None:
        return None if value is None else check_file(value, endings)

    return check


def folder_option(new: bool = False) -> Callable[[Path | None], Path | None]:
    """Return the callback of an option that names a folder to write."""

    def check(value: Path | None) -> Path | None:
        return None if value is None else check_folder(value, new)

    return check


def any_of(names: Iterable[str]) -> str:
    """Return names as in ``.csv, .jsonl or .mcap``."""
    *most, last = names
    return f"{', '.join(most)} or {last}" if most else last


def _try_folder(folder: Path) -> None:
    """Raise OSError if no file can be made in a folder; permission bits are not enough to know."""
    with tempfile.TemporaryFile(dir=folder):
        pass


def _reason(error: OSError, parent: Path) -> str:
    if error.errno == errno.ENOENT:
        return f"there is no folder {parent}"
    if error.errno == errno.ENOTDIR:
        return f"{parent} is not a folder"
    return error.strerror or str(error)
