"""A bounded queue between threads: the newest items stay, and every loss is counted."""

from __future__ import annotations

import threading
from collections import Counter, deque
from collections.abc import Hashable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class BoundedQueue(Generic[T]):
    """A queue that drops old items rather than grow.

    Parameters
    ----------
    max_waiting : int
        How many items may wait, urgent and other ones each. One more drops the oldest of the
        sender that has most waiting: a sender that floods the queue loses only its own.

    Attributes
    ----------
    counts : Counter
        ``received``, ``dropped``, and the events that :meth:`count` is called with.
    """

    def __init__(self, max_waiting: int = 256) -> None:
        self._max_waiting = max_waiting
        self._items: deque[tuple[Hashable, T]] = deque()
        self._urgent: deque[tuple[Hashable, T]] = deque()
        self._readers = 0
        self._change = threading.Condition()
        self._closed = False
        self.counts: Counter[str] = Counter()

    def put(
        self, item: T, sender: Hashable = None, wait: bool = False, urgent: bool = False
    ) -> None:
        """Add an item of a sender; ``wait`` for room rather than drop another.

        An urgent item overtakes all that are not.
        """
        items = self._urgent if urgent else self._items
        with self._change:
            if wait:
                self._change.wait_for(lambda: len(items) < self._max_waiting or self._closed)
            elif len(items) >= self._max_waiting:
                busiest = Counter(sender for sender, _ in items).most_common(1)[0][0]
                del items[next(k for k, (sender, _) in enumerate(items) if sender == busiest)]
                self.counts["dropped"] += 1
            items.append((sender, item))
            self.counts["received"] += 1
            self._change.notify_all()

    def get(self, timeout: float | None = None) -> T | None:
        """Remove and return the oldest item; None if there is none within ``timeout`` [s]."""
        with self._change:
            self._readers += 1
            self._change.notify_all()
            self._change.wait_for(lambda: len(self) or self._closed, timeout)
            self._readers -= 1
            items = self._urgent or self._items
            if not items:
                return None
            self._change.notify_all()
            return items.popleft()[1]

    def wait_for_reader(self) -> bool:
        """Block until a reader waits for an item that is not there; False: it is closed."""
        with self._change:
            self._change.wait_for(lambda: self._readers > len(self) or self._closed)
            return not self._closed

    def count(self, event: str) -> None:
        """Count an event; from any thread."""
        with self._change:
            self.counts[event] += 1

    def close(self) -> None:
        """Declare that no more items come; those that wait can still be fetched."""
        with self._change:
            self._closed = True
            self._change.notify_all()

    @property
    def finished(self) -> bool:
        """Whether it is closed and empty."""
        return self._closed and not len(self)

    def __len__(self) -> int:
        return len(self._items) + len(self._urgent)

    def report(self) -> dict[str, Any]:
        """Return the counts, and how many items wait."""
        with self._change:
            return {**self.counts, "waiting": len(self)}
