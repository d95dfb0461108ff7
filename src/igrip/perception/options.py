"""Options of hand detectors and pose estimators, from the command line and from Python."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from pydantic import ValidationError

from igrip.errors import IgripError
from igrip.settings import Settings, problem_of

S = TypeVar("S", bound=Settings)


def parse_options(texts: Sequence[str]) -> dict[str, Any]:
    """Return the options in texts ``NAME=VALUE``; a value may be JSON. Others raise IgripError."""
    options: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name:
            raise IgripError(f"option {text!r}: write NAME=VALUE")
        try:
            options[name] = json.loads(value) if value[:1] in "{[" else value
        except ValueError as error:
            raise IgripError(f"option {name}: is no JSON: {error}") from None
    return options


def validated(kind: type[S], name: str, options: Mapping[str, Any] | S | None) -> S:
    """Return options as settings of this kind, or raise an IgripError that begins with ``name``."""
    if isinstance(options, kind):
        return options
    try:
        return kind(**dict(options or {}))
    except ValidationError as error:
        raise IgripError(f"{name}: {problem_of(error)}") from error
