"""The queue between inputs and the estimator."""

from __future__ import annotations

import threading

from igrip.runtime.bounded_queue import BoundedQueue


def in_thread(work):
    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread


def test_the_newest_stay_and_every_loss_is_counted():
    queue = BoundedQueue(max_waiting=4)
    for k in range(10):
        queue.put(k)
    assert [queue.get(0.0) for _ in range(5)] == [6, 7, 8, 9, None]
    assert queue.report() == {"received": 10, "dropped": 6, "waiting": 0}


def test_a_sender_that_floods_loses_only_its_own():
    queue = BoundedQueue(max_waiting=8)
    for k in range(3):
        queue.put(("quiet", k), sender="quiet")
    for k in range(100):
        queue.put(("loud", k), sender="loud")
    queue.put(("quiet", 3), sender="quiet")
    left = [queue.get(0.0) for _ in range(8)]
    assert [k for sender, k in left if sender == "quiet"] == [0, 1, 2, 3]
    assert [k for sender, k in left if sender == "loud"] == [96, 97, 98, 99]
    assert queue.report() == {"received": 104, "dropped": 96, "waiting": 0}


def test_urgent_items_overtake_and_are_bounded_and_counted_too():
    queue = BoundedQueue(max_waiting=3)
    queue.put("observation")
    queue.put("veto", sender="quiet", urgent=True)
    for k in range(5):
        queue.put(k, sender="loud", urgent=True)
    assert [queue.get(0.0) for _ in range(4)] == ["veto", 3, 4, "observation"]
    assert queue.report() == {"received": 7, "dropped": 3, "waiting": 0}


def test_a_sender_that_waits_loses_nothing():
    queue = BoundedQueue(max_waiting=2)

    def fill():
        for k in range(50):
            queue.put(k, wait=True)
        queue.close()

    in_thread(fill)
    items = []
    while not queue.finished:
        if (item := queue.get(1.0)) is not None:
            items.append(item)
    assert items == list(range(50))
    assert queue.counts["dropped"] == 0


def test_get_returns_without_an_item_after_its_timeout_and_at_the_end():
    queue = BoundedQueue()
    assert queue.get(0.01) is None
    items = []
    thread = in_thread(lambda: items.append(queue.get(60.0)))
    queue.close()
    thread.join(30.0)
    assert items == [None]
    assert queue.finished


def test_a_source_that_waits_for_a_reader_is_never_ahead_of_it():
    queue = BoundedQueue()
    produced = []

    def produce():
        while queue.wait_for_reader():
            produced.append(len(produced))
            queue.put(produced[-1])

    thread = in_thread(produce)
    for k in range(200):
        assert len(produced) == k  # nothing was made in advance
        assert queue.get(60.0) == k
    queue.close()
    thread.join(30.0)
    assert not thread.is_alive()
