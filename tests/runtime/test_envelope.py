"""Intentions as they leave: numbered, aged, and without leases that have ended."""

from __future__ import annotations

import json

import msgspec
import pytest

from igrip.intention import Commitment, Intention
from igrip.runtime.envelope import Sequencer

LEASE = Commitment(target="cup", grip="palmar", since=1.9, valid_until=2.12)
INTENTION = Intention(t=2.0, hand="right", status="reaching", commitment=LEASE)


def test_age_counts_from_arrival_and_is_subtracted_from_the_lease_when_it_leaves():
    now = [2.0]
    envelope = Sequencer(lambda: now[0]).wrap(INTENTION, arrived=2.0)
    for late, left in ((0.0, 0.12), (0.091, 0.029), (0.119, 0.001), (0.12, None), (9.0, None)):
        now[0] = 2.0 + late
        message = envelope.to_dict()
        assert message["age"] == pytest.approx(late)
        assert message["valid_for"] == (None if left is None else pytest.approx(left))
        assert (message["commitment"] is None) is (left is None)


def test_envelopes_are_numbered_and_the_same_in_both_encodings():
    sequencer = Sequencer(lambda: 2.0)
    envelopes = [sequencer.wrap(INTENTION, 2.0) for _ in range(3)]
    assert [one.seq for one in envelopes] == [1, 2, 3]
    assert {one.session for one in envelopes} == {sequencer.session}
    plain = json.loads(envelopes[0].to_json())
    packed = msgspec.msgpack.decode(envelopes[0].to_msgpack())
    assert plain.pop("sent") <= packed.pop("sent")
    assert plain == packed
    assert {**plain, **INTENTION.to_dict()} == plain
