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


def test_each_key_has_its_newest_item_and_keeps_its_place():
    """Of two equally fast senders the one would else never be read."""
    mailbox, items = Mailbox(), []
    for k in range(6):
        mailbox.put(("hands", k), "hands")
        mailbox.put(("objects", k), "objects")
        items.append(mailbox.get(0.0))
    assert [kind for kind, _ in items] == ["hands", "objects"] * 3
    assert items[-1] == ("objects", 5)


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
