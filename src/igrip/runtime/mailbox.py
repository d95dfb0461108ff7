"""A place between two threads that holds one thing: the newest. Nothing queues up."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Holds what was put last and not taken yet.

    Attributes
    ----------
    put_in, replaced : int
        How many things came, and how many of them a newer one replaced before they were taken.
    """

    def __init__(self) -> None:
        self._item: T | None = None
        self._change = threading.Condition()
        self._closed = False
        self.put_in = self.replaced = 0

    def put(self, item: T) -> None:
        """Put a thing in; returns at once."""
        with self._change:
            self.replaced += self._item is not None
            self.put_in += 1
            self._item = item
            self._change.notify_all()

    def take(self, timeout: float | None = None) -> T | None:
        """Take the thing out.

        Returns
        -------
        T or None
            None if there is none for so long [s], or if nothing more will come.
        """
        with self._change:
            self._change.wait_for(lambda: self._item is not None or self._closed, timeout)
            item, self._item = self._item, None
            return item

    def close(self) -> None:
        """Say that nothing more will come; what is there can still be taken."""
        with self._change:
            self._closed = True
            self._change.notify_all()

    @property
    def over(self) -> bool:
        """Whether nothing is there and nothing will come."""
        with self._change:
            return self._closed and self._item is None
