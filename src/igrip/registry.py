"""Families of interchangeable parts (cues, targets estimators, …), found by name.

A member is one file: every module of the family's package is imported when a name is first asked
for, and installed packages may add members through an entry point of the family's group.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Generic, TypeVar

from igrip.errors import UnknownNameError

T = TypeVar("T")


class Registry(Generic[T]):
    """The members of one family by name.

    Parameters
    ----------
    family : str
        What a member is called in messages, for example ``"cue"``.
    package : str
        The package whose modules are the built-in members; it is also the entry-point group of
        members that other distributions bring.
    """

    def __init__(self, family: str, package: str) -> None:
        self.family = family
        self.package = package
        self._members: dict[str, T] = {}
        self._complete = False

    def register(self, name: str) -> Callable[[T], T]:
        """Return a decorator that adds a member under ``name``."""

        def add(member: T) -> T:
            if self._members.setdefault(name, member) is not member:
                raise ValueError(f"there is a {self.family} named {name!r} already")
            return member

        return add

    def get(self, name: str) -> T:
        """Return the member called ``name``.

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the valid names.
        """
        self._discover()
        try:
            return self._members[name]
        except KeyError:
            raise UnknownNameError(self.family, name, self.names()) from None

    def names(self) -> tuple[str, ...]:
        """Return the names of all members, sorted."""
        self._discover()
        return tuple(sorted(self._members))

    def _discover(self) -> None:
        if self._complete:
            return
        package = importlib.import_module(self.package)
        for module in pkgutil.iter_modules(package.__path__):
            importlib.import_module(f"{self.package}.{module.name}")
        for point in entry_points(group=self.package):
            self._members.setdefault(point.name, point.load())
        self._complete = True  # last: if a module fails, the next call says so again
