"""A hand-over between threads in which a newer item replaces an older one."""

from __future__ import annotations

import threading
from collections.abc import Hashable
from typing import Generic, TypeVar

T = TypeVar("T")


class Mailbox(Generic[T]):
    """Holds the newest item of each key until it is fetched.

    Attributes
    ----------
    received, replaced : int
        How many items were put, and how many a newer one of the same key replaced.
    """

    def __init__(self) -> None:
        self._items: dict[Hashable, T] = {}
        self._change = threading.Condition()
        self._closed = False
        self.received = self.replaced = 0

    def put(self, item: T, key: Hashable = None) -> None:
        """Add an item in place of the one that waits under its key; never blocks.

        It keeps the place of the one it replaces: of two equally fast senders none starves.
        """
        with self._change:
            self.replaced += key in self._items
            self.received += 1
            self._items[key] = item
            self._change.notify_all()

    def get(self, timeout: float | None = None) -> T | None:
        """Remove and return the item that has waited longest.

        Returns
        -------
        T or None
            None if there is none within ``timeout`` [s], or if the mailbox is closed and empty.
        """
        with self._change:
            self._change.wait_for(lambda: self._items or self._closed, timeout)
            return self._items.pop(next(iter(self._items))) if self._items else None

    def close(self) -> None:
        """Declare that no more items come; those that wait can still be fetched."""
        with self._change:
            self._closed = True
            self._change.notify_all()

    @property
    def finished(self) -> bool:
        """Whether it is closed and empty."""
        with self._change:
            return self._closed and not self._items
