"""The receiver against the rule that docs/clients gives to other programs, and against rubbish."""

from __future__ import annotations

import importlib.util
import json
import math
import random
from pathlib import Path

import pytest

from igrip.drive.receiver import Receiver
from runtime_fakes import Clock

CLIENT = Path(__file__).parents[2] / "docs" / "clients" / "lease.py"


def message(seq, valid_for, session="a", sent=0.0, **changes):
    lease = {"target": "cup", "grip": "palmar", "since": 0.0}
    return {
        "session": session, "seq": seq, "sent": sent, "hand": "right", "status": "reaching",
        "commitment": lease if valid_for is not None else None, "valid_for": valid_for,
    } | changes  # fmt: skip


def test_it_permits_when_the_published_client_does_and_never_longer():
    spec = importlib.util.spec_from_file_location("lease", CLIENT)
    client = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(client)
    random.seed(1)
    for _ in range(50):
        clock = Clock(0.0)
        theirs, ours, until = client.Lease(clock), Receiver("right", clock), 0.0
        sent, seq = 100.0, 0
        for _ in range(60):
            step = random.expovariate(30.0)
            clock.t, sent = clock.t + step, sent + step
            seq += random.choice((1, 1, 1, 0, -1, 2))
            late = random.choice((0.0, 0.0, 0.02, 0.2))
            valid = random.choice((None, 0.05, 0.12, 9.0))
            one = message(max(1, seq), valid, sent=sent - late)
            theirs.update(one)
            decision = ours.read(one)
            if decision is not None:
                until = decision.until
            for ahead in (0.0, 0.04, 0.1, 0.2):
                clock.t += ahead
                assert (clock.t < until) == theirs.permits()
                clock.t -= ahead


def test_on_one_clock_the_whole_delay_counts():
    clock = Clock(5.0)
    receiver = Receiver("right", clock, same_clock=True)
    decision = receiver.read(message(1, 0.12, sent=4.93))
    assert decision.until == pytest.approx(5.05)
    assert receiver.read(message(2, 0.12, sent=5.5)).until == 0.0  # from the future


def test_an_ended_session_does_not_come_back():
    receiver = Receiver("right", Clock(0.0))
    assert receiver.read(message(9, 0.1, "a")) is not None
    assert receiver.read(message(1, 0.1, "b")) is not None
    assert receiver.read(message(10, 0.1, "a")) is None
    assert receiver.counts["ended"] == 1


def test_another_hand_gets_nothing():
    receiver = Receiver("right", Clock(0.0))
    assert receiver.read(message(1, 0.1, hand="left")) is None


@pytest.mark.parametrize("field", ["session", "seq", "sent", "hand", "status", "valid_for"])
@pytest.mark.parametrize("value", [None, math.nan, -math.inf, [], {}, True, "x" * 1000, -1])
def test_a_wrong_field_permits_nothing(field, value):
    receiver = Receiver("right", Clock(0.0))
    decision = receiver.read(message(1, 0.1) | {field: value})
    assert decision is None or decision.until <= 0.0 or field in ("sent",)


def test_rubbish_permits_nothing_and_raises_nothing():
    random.seed(2)
    whole = json.dumps(message(1, 0.1))
    receiver = Receiver("right", Clock(0.0))
    for _ in range(5000):
        text = list(whole)
        for _ in range(random.randint(1, 4)):
            text[random.randrange(len(text))] = chr(random.randrange(32, 127))
        try:
            value = json.loads("".join(text))
        except ValueError:
            continue
        decision = receiver.read(value)
        assert decision is None or 0.0 <= decision.until <= 0.15 + 1e-9
