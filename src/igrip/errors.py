"""The errors igrip raises; every one of them is an :class:`IgripError`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager


def did_you_mean(name: str, choices: Iterable[str]) -> str:
    """Return `` (did you mean 'CHOICE'?)`` for the choice nearest to a name; "" if none is near.

    A name that is a part of one choice alone, such as ``mustard``, is near to it.
    """
    from difflib import get_close_matches  # only where something went wrong

    choices = list(choices)
    near = get_close_matches(name, choices, n=1)
    if not near and len(name) >= 3:
        holding = [choice for choice in choices if name.lower() in choice.lower()]
        near = holding if len(holding) == 1 else []
    return f" (did you mean {near[0]!r}?)" if near else ""


class IgripError(Exception):
    """Base of all errors raised by igrip."""


class ObservationError(IgripError, ValueError):
    """A message is malformed. Nothing was changed by it.

    Attributes
    ----------
    field : str
        Path of the offending field, for example ``hands.right.position[0]``.
    object_id : str or None
        The one object that the estimator refuses; without it, the message is accepted. An id may
        hold dots and brackets, so it cannot be read off ``field``.
    """

    def __init__(self, field: str, problem: str, object_id: str | None = None) -> None:
        super().__init__(f"{field}: {problem}")
        self.field = field
        self.problem = problem
        self.object_id = object_id

    def __reduce__(self) -> tuple[type[ObservationError], tuple[str, str, str | None]]:
        return type(self), (self.field, self.problem, self.object_id)


class ObjectsError(IgripError, ValueError):
    """A catalogue of objects cannot be read or does not describe usable meshes."""


class MeshUnitError(ObjectsError):
    """A mesh is implausible in metres and its unit was not declared."""


class UnknownModelError(IgripError, KeyError):
    """A catalogue holds no model of this name."""

    def __str__(self) -> str:  # KeyError would print the message quoted
        return str(self.args[0])


class UnknownNameError(IgripError, ValueError):
    """No member of a family (cue, targets estimator, grip selector, …) has this name."""

    def __init__(self, family: str, name: str, choices: Iterable[str]) -> None:
        self.family, self.name, self.choices = family, name, tuple(choices)
        near = did_you_mean(name, self.choices)
        listed = ", ".join(self.choices)
        super().__init__(f"no {family} is named {name!r}{near}; there are: {listed}")

    def __reduce__(self) -> tuple[type[UnknownNameError], tuple[str, str, tuple[str, ...]]]:
        return type(self), (self.family, self.name, self.choices)


class StorageError(IgripError, OSError):
    """Shared storage does not answer as it should: no fault of a recording, and worth a retry."""


class RecordingError(IgripError, ValueError):
    """A recording cannot be read; the message names the file and the line."""


class DatasetError(IgripError, ValueError):
    """A dataset folder is incomplete or contradicts itself."""


class CameraError(IgripError):
    """A camera is not there, cannot be opened or has stopped; the message says what to do."""


def requirements_of(extra: str) -> list[str]:
    """Return what an extra of the installed igrip requires, such as ``["viser>=1.0"]``."""
    from importlib.metadata import PackageNotFoundError, requires  # only where one is missing

    try:
        lines = requires("igrip") or []
    except PackageNotFoundError:  # a bare source tree
        lines = []
    pairs = (line.partition(";")[::2] for line in lines)
    return [name.strip() for name, marker in pairs if re.search(f"['\"]{extra}['\"]", marker)]


def install_command(extra: str) -> str:
    """Return a command that installs what an extra requires.

    It names the packages themselves: so it works wherever igrip was installed from.
    """
    packages = requirements_of(extra) or [f"igrip[{extra}]"]
    return " ".join(["pip install", *(f"'{package}'" for package in packages)])


class MissingExtraError(IgripError, ImportError):
    """An optional dependency is not installed; the message says how to get it."""

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        remedy = install_command(extra)
        super().__init__(f"{purpose} needs the package {package!r} (extra {extra}): {remedy}")
        self.package, self.extra, self.purpose = package, extra, purpose

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str, str]]:
        return type(self), (self.package, self.extra, self.purpose)


@contextmanager
def requires_extra(
    package: str, extra: str, purpose: str, errors: tuple[type[Exception], ...] = (ImportError,)
) -> Iterator[None]:
    """Raise :class:`MissingExtraError` where the imports inside fail.

    Parameters
    ----------
    package : str
        The distribution to install.
    extra : str
        The extra of igrip that brings it.
    purpose : str
        What needs it.
    errors : tuple of exception types
        What a failed import raises; a few packages raise others than ``ImportError``.

    Examples
    --------
    >>> with requires_extra("websockets", "viewer", "the page in the browser"):
    ...     import websockets
    """
    try:
        yield
    except errors as error:
        raise MissingExtraError(package, extra, purpose) from error
