"""Small JSON files of cameras: lenses, and where cameras stand."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from igrip.errors import CameraError
from igrip.io.text import read_text

T = TypeVar("T")


def read_json(path: str | Path, what: str, parse: Callable[[Any], T]) -> T:
    """Return what ``parse`` makes of a file's content; ``what`` is in the message of the error.

    Raises
    ------
    CameraError
        If the file cannot be read, or is none of these.
    """
    try:
        return parse(json.loads(read_text(path)))
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise CameraError(f"{path}: is no {what}: {error!r}") from None


def write_json(path: str | Path, content: Mapping[str, Any]) -> None:
    """Write a file.

    Raises
    ------
    CameraError
        If it cannot be written.
    """
    try:
        Path(path).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise CameraError(f"{path}: {error.strerror or error}") from error
