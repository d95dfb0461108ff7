"""Families of interchangeable parts (cues, targets estimators, cameras, …), found by name.

A member is one file: a module of the family's package, under the member's own name. Listing the
names imports none of them; asking for one imports that one. Modules whose name begins with an
underscore, and packages, are shared by members and are none. Installed distributions add members
through an entry point of the family's group.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
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
        The package whose modules are the built-in members.
    group : str, optional
        The entry-point group of members that other distributions bring; by default ``package``.
    """

    def __init__(self, family: str, package: str, group: str | None = None) -> None:
        self.family = family
        self.package = package
        self.group = group or package
        self._members: dict[str, T] = {}
        self._modules: frozenset[str] | None = None
        self._points: dict[str, EntryPoint] = {}

    def register(self, name: str) -> Callable[[T], T]:
        """Return a decorator that adds a member under ``name``."""

        def add(member: T) -> T:
            if self._members.setdefault(name, member) is not member:
                raise ValueError(f"there is a {self.family} named {name!r} already")
            return member

        return add

    def get(self, name: str) -> T:
        """Return the member called ``name``; its module is imported if it was not yet.

        Raises
        ------
        UnknownNameError
            If there is none; the message lists the valid names.
        """
        self.check(name)
        if name in self._members:
            return self._members[name]
        if name in self._discover():
            importlib.import_module(f"{self.package}.{name}")
            if name not in self._members:
                raise RuntimeError(f"{self.package}.{name} does not register {name!r}")
        else:
            self._members[name] = self._points[name].load()
        return self._members[name]

    def check(self, name: str) -> None:
        """Raise :class:`UnknownNameError` if no member is called ``name``; imports none."""
        if name not in self._members and name not in self.names():
            raise UnknownNameError(self.family, name, self.names())

    def names(self) -> tuple[str, ...]:
        """Return the names of all members, sorted; imports none of them."""
        return tuple(sorted({*self._discover(), *self._points, *self._members}))

    def _discover(self) -> frozenset[str]:
        if self._modules is None:
            package = importlib.import_module(self.package)
            self._points = {point.name: point for point in entry_points(group=self.group)}
            self._modules = frozenset(
                module.name
                for module in pkgutil.iter_modules(package.__path__)
                if not module.ispkg and not module.name.startswith("_")
            )
        return self._modules
