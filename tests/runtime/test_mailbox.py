"""A place that holds the newest thing."""

from __future__ import annotations

import threading

from igrip.runtime.mailbox import Mailbox


def test_a_newer_thing_replaces_what_nobody_took_and_is_counted():
    place = Mailbox()
    for k in range(5):
        place.put(k)
    assert place.take(0.0) == 4
    assert place.take(0.0) is None
    assert (place.put_in, place.replaced) == (5, 4)


def test_what_is_there_can_be_taken_after_the_end():
    place = Mailbox()
    place.put("last")
    place.close()
    assert not place.over
    assert place.take() == "last"
    assert place.over
    assert place.take() is None


def test_one_that_waits_wakes_for_a_thing_and_for_the_end():
    place, got = Mailbox(), []

    def wait():
        while not place.over:
            got.append(place.take())

    thread = threading.Thread(target=wait)
    thread.start()
    place.put(1)
    while not got:
        pass
    place.close()
    thread.join(5.0)
    assert not thread.is_alive()
    assert got == [1] or got == [1, None]
