"""The options in a camera's name: ``oak:ID?size=1280x720&fps=30``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import unquote

from igrip.errors import CameraError, did_you_mean


def split_options(rest: str, defaults: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Split what follows a camera's scheme, such as ``FILE?speed=0``, into device and options.

    Parameters
    ----------
    rest : str
        What follows.
    defaults : mapping
        Every option there is; each value is read as the type of its default: str, float, bool or a
        size, such as ``1280x720``.

    Raises
    ------
    CameraError
        If an option is unknown or malformed.
    """
    device, _, text = rest.partition("?")
    options = dict(defaults)
    for part in text.split("&") if text else ():
        key, _, value = part.partition("=")
        if key not in defaults:
            near = did_you_mean(key, defaults)
            raise CameraError(f"no option is named {key!r}{near}; there are: {', '.join(defaults)}")
        try:
            options[key] = _convert(unquote(value), defaults[key])
        except ValueError:
            raise CameraError(f"{key}: {value!r} is not of the form {defaults[key]!r}") from None
    return device, options


def _convert(text: str, like: Any) -> Any:
    if isinstance(like, bool):
        if text.lower() not in ("0", "1", "true", "false"):
            raise ValueError(text)
        return text.lower() in ("1", "true")
    if isinstance(like, float):
        number = float(text)
        if not 0.0 <= number < 1e6:
            raise ValueError(text)
        return number
    if isinstance(like, tuple):
        width, height = map(int, text.lower().split("x"))
        if min(width, height) < 1:
            raise ValueError(text)
        return width, height
    return text
