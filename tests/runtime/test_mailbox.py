"""The mailbox that holds the newest item."""

from __future__ import annotations

import threading

from igrip.runtime.mailbox import Mailbox


def test_a_newer_item_replaces_one_that_waits_and_is_counted():
    mailbox = Mailbox()
    for k in range(5):
        mailbox.put(k)
    assert mailbox.get(0.0) == 4
    assert mailbox.get(0.0) is None
    assert (mailbox.received, mailbox.replaced) == (5, 4)


def test_each_key_has_its_newest_item_in_order_of_arrival():
    mailbox = Mailbox()
    for key, item in (("hands", 1), ("objects", 2), ("hands", 3)):
        mailbox.put(item, key)
    assert [mailbox.get(0.0) for _ in range(3)] == [2, 3, None]
    assert (mailbox.received, mailbox.replaced) == (3, 1)


def test_items_that_wait_can_be_fetched_after_the_end():
    mailbox = Mailbox()
    mailbox.put("last")
    mailbox.close()
    assert not mailbox.finished
    assert mailbox.get() == "last"
    assert mailbox.finished
    assert mailbox.get() is None


def test_a_reader_wakes_for_an_item_and_for_the_end():
    mailbox, items, first = Mailbox(), [], threading.Event()

    def read():
        while not mailbox.finished:
            items.append(mailbox.get())
            first.set()

    thread = threading.Thread(target=read, daemon=True)
    thread.start()
    mailbox.put(1)
    assert first.wait(60.0)
    mailbox.close()
    thread.join(60.0)
    assert not thread.is_alive()
    assert items in ([1], [1, None])
