"""Between the edges and the estimator: a bounded queue; the newest stay, all losses are counted."""

from __future__ import annotations

import threading
from collections import Counter, deque
from collections.abc import Hashable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Inbox(Generic[T]):
    """What has come and is not taken yet.

    Parameters
    ----------
    most : int
        How many may wait. One more pushes out the oldest of the sender that has most waiting, so
        that one that floods crowds out itself alone; or it waits (``put(wait=True)``).

    Attributes
    ----------
    counts : Counter
        ``taken`` in, ``pushed_out``, and whatever the edges count (``malformed``, …).
    """

    def __init__(self, most: int = 256) -> None:
        self._most = most
        self._items: deque[tuple[Hashable, T]] = deque()
        self._waiting: Counter[Hashable] = Counter()  # of each sender
        self._first: deque[T] = deque(maxlen=most)
        self._change = threading.Condition()
        self._closed = False
        self.counts: Counter[str] = Counter()

    def put(self, item: T, wait: bool = False, sender: Hashable = None) -> None:
        """Add an item; where there is no room, wait for some or push out another."""
        with self._change:
            if wait:
                self._change.wait_for(lambda: len(self._items) < self._most or self._closed)
            elif len(self._items) >= self._most:
                self._push_out()
            self._items.append((sender, item))
            self._waiting[sender] += 1
            self.counts["taken"] += 1
            self._change.notify_all()

    def _push_out(self) -> None:
        greediest = max(self._waiting, key=lambda sender: self._waiting[sender])
        place = next(k for k, (sender, _) in enumerate(self._items) if sender == greediest)
        del self._items[place]
        self._gone(greediest)
        self.counts["pushed_out"] += 1

    def _gone(self, sender: Hashable) -> None:
        self._waiting[sender] -= 1
        if not self._waiting[sender]:
            del self._waiting[sender]

    def put_first(self, item: T) -> None:
        """Add an item that overtakes all others, and that none pushes out."""
        with self._change:
            self._first.append(item)
            self._change.notify_all()

    def get(self, timeout: float) -> T | None:
        """Return the oldest item; None if there is none for so long [s]."""
        with self._change:
            self._change.wait_for(lambda: self._items or self._first or self._closed, timeout)
            if self._first:
                return self._first.popleft()
            if not self._items:
                return None
            sender, item = self._items.popleft()
            self._gone(sender)
            self._change.notify_all()
            return item

    def count(self, what: str) -> None:
        """Count something that befell what came in."""
        with self._change:
            self.counts[what] += 1

    def close(self) -> None:
        """Say that nothing more will come."""
        with self._change:
            self._closed = True
            self._change.notify_all()

    @property
    def over(self) -> bool:
        """Whether nothing is left and nothing will come."""
        with self._change:
            return self._closed and not self._items and not self._first

    def __len__(self) -> int:
        return len(self._items)

    def report(self) -> dict[str, Any]:
        """Return what was counted, and how many wait."""
        with self._change:
            return {**self.counts, "waiting": len(self._items)}
