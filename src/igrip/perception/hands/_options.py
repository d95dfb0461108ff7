"""Options of hand detectors, from the command line and from Python."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from igrip.errors import IgripError
from igrip.settings import Settings, problem_of

S = TypeVar("S", bound=Settings)


def hand_options(kind: type[S], detector: str, options: Mapping[str, Any] | S | None) -> S:
    """Return a detector's options as its settings, or raise an IgripError that names it."""
    if isinstance(options, kind):
        return options
    try:
        return kind(**dict(options or {}))
    except ValidationError as error:
        raise IgripError(f"hands {detector}: {problem_of(error)}") from error
