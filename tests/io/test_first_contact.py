"""The check of a stream: on its first messages, and never again a refusal after that."""

from __future__ import annotations

from igrip.io.first_contact import MESSAGES, FirstContact
from igrip.io.plausibility import refusal
from igrip.observation import Observation


def messages(count, step=1 / 30, begin=0.0, seen=lambda k: True):
    """Return messages of a hand that moves 5 mm a message."""
    for k in range(count):
        hands = {"right": {"position": [0.005 * k, 0.1, 0.0]}} if seen(k) else {}
        yield Observation(t=begin + step * k, hands=hands)


def refusals(contact, stream):
    return [refusal(contact.findings) for m in stream if contact.add(m)]


def test_milliseconds_for_seconds_are_refused_early():
    found = refusals(FirstContact(), messages(10, step=33.3))
    assert "steps of 33.3 s: are these ms?" in found[0]


def test_a_hand_that_is_rarely_measured_does_not_change_the_unit():
    """Messages come at 30 Hz; faults leave a hand's measurement every 3 s."""
    found = refusals(FirstContact(), messages(600, seen=lambda k: k % 90 == 0))
    assert found == [None] * len(found)


def test_what_was_plausible_once_is_not_refused_later():
    contact = FirstContact()
    assert refusals(contact, messages(MESSAGES)) == [None] * 4
    later = refusals(contact, messages(MESSAGES, step=33.3, begin=100.0))
    assert later == [None] * len(later)
    assert [f.verdict for f in contact.findings if f.kind == "interval"] == ["remark"]


def test_a_stream_that_is_refused_stays_refused():
    contact = FirstContact()
    found = refusals(contact, messages(3 * MESSAGES, step=33.3))
    assert all("are these ms?" in text for text in found)
