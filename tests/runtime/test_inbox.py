"""The queue between the edges and the estimator."""

from __future__ import annotations

import threading
import time

from igrip.runtime.inbox import Inbox


def test_the_newest_stay_and_every_loss_is_counted():
    inbox = Inbox(most=4)
    for k in range(10):
        inbox.put(k)
    assert [inbox.get(0.0) for _ in range(5)] == [6, 7, 8, 9, None]
    assert inbox.report() == {"taken": 10, "pushed_out": 6, "waiting": 0}


def test_who_floods_crowds_out_nobody_else():
    inbox = Inbox(most=8)
    for k in range(3):
        inbox.put(("quiet", k), sender="quiet")
    for k in range(100):
        inbox.put(("loud", k), sender="loud")
    inbox.put(("quiet", 3), sender="quiet")
    left = [inbox.get(0.0) for _ in range(8)]
    assert [k for who, k in left if who == "quiet"] == [0, 1, 2, 3]
    assert [k for who, k in left if who == "loud"] == [96, 97, 98, 99]
    assert inbox.report() == {"taken": 104, "pushed_out": 96, "waiting": 0}


def test_one_that_waits_loses_nothing():
    inbox = Inbox(most=2)

    def fill():
        for k in range(50):
            inbox.put(k, wait=True)
        inbox.close()

    threading.Thread(target=fill, daemon=True).start()
    got = []
    while not inbox.over:
        if (item := inbox.get(1.0)) is not None:
            got.append(item)
    assert got == list(range(50))


def test_getting_waits_no_longer_than_told_and_wakes_at_the_end():
    inbox = Inbox()
    begin = time.monotonic()
    assert inbox.get(0.02) is None
    assert time.monotonic() - begin >= 0.02
    threading.Timer(0.02, inbox.close).start()
    assert inbox.get(10.0) is None
    assert inbox.over
