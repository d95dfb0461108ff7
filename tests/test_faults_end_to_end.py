"""Leases under faults, watched from outside the process: ``igrip stream`` on the sender's clock."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections import Counter

import pytest

import igrip
from igrip.lab.simulation.demo import DemoPerson
from igrip.lab.simulation.faults import KINDS, Fault, inject
from observer import BELIEVED, Observer
from support import every_kind


def person(ycb, seconds, seed=0):
    """Yield the demo's messages for so long."""
    moments = (moment.observation for moment in DemoPerson(ycb, seed))
    return itertools.takewhile(lambda message: message.t < seconds, moments)


def watched(messages, *options):
    """Feed messages to the service in its own process; return the observer and all intentions."""
    messages = list(messages)
    done = subprocess.run(
        [sys.executable, "-m", "igrip", "stream", "--in", "stdin", "--out", "stdout", *options],
        input=b"".join(message.to_json() + b"\n" for message in messages),
        capture_output=True, check=True,
    )  # fmt: skip
    intentions = [json.loads(line) for line in done.stdout.splitlines()]
    observer, answers = Observer(), iter(intentions)
    waiting = next(answers, None)
    for message in messages:
        observer.sent(json.loads(message.to_json()))
        while waiting is not None and waiting["t"] <= message.t:
            assert waiting["t"] == message.t
            observer.said(waiting)
            waiting = next(answers, None)
    assert waiting is None
    assert [i["seq"] for i in intentions] == list(range(1, len(intentions) + 1))
    return observer, intentions


def faulty(ycb, seconds, rate, seed):
    counts = Counter()
    faults = [*every_kind(rate), Fault("freeze", rate=0.05, lasts=1.2)]
    messages = list(inject(person(ycb, seconds, seed), faults, seed, counts))
    return messages, counts


def test_no_lease_breaks_a_promise_under_faults_of_every_kind(ycb):
    messages, counts = faulty(ycb, seconds=300.0, rate=8.0, seed=1)
    assert set(counts) == set(KINDS)
    assert sum(counts.values()) > 1000
    observer, _ = watched(messages, "--reliability", "0")
    assert observer.violations == []
    assert observer.commitments > 100  # it was not simply silent


def test_a_piped_recording_gives_what_the_estimator_gives(ycb):
    """Every intention, bit for bit, and as many leases, whatever else the machine does."""
    messages, _ = faulty(ycb, seconds=60.0, rate=1.0, seed=2)
    _, piped = watched(messages)
    estimator = igrip.Estimator(ycb)
    expected = [i.to_dict() for message in messages for i in estimator.update(message)]
    assert [{key: i[key] for key in one} for i, one in zip(piped, expected, strict=True)] == (
        json.loads(json.dumps(expected))
    )
    assert sum(i["commitment"] is not None for i in expected) > 200
    assert {i["age"] for i in piped} == {0.0}


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_a_hundred_thousand_faults(ycb):
    """Some storms, in which there is hardly ever a lease, and long weather that allows many."""
    total, commitments = 0, 0
    for seed, rate in enumerate([14.0] * 12 + [2.0] * 24):
        messages, counts = faulty(ycb, seconds=600.0, rate=rate, seed=100 + seed)
        observer, _ = watched(messages, "--reliability", "0")
        assert observer.violations == []
        total += sum(counts.values())
        commitments += observer.commitments
    print(f"{total} faults, {commitments} leases, no violation")
    assert total >= 100_000
    assert commitments > 10_000


@pytest.mark.parametrize("kind", sorted(KINDS))
@pytest.mark.parametrize("lasts", [0.2, 1.0])
def test_the_stream_recovers_within_half_a_second(ycb, kind, lasts):
    fault = Fault(kind, at=5.0, lasts=lasts)
    estimator = igrip.Estimator(ycb, igrip.Config(targets="paper"))
    ends = 5.0 + lasts
    back = {}
    for message in inject(person(ycb, ends + 1.5), [fault], seed=4):
        for intention in estimator.update(message):
            if message.t > ends and intention.status in BELIEVED:
                back.setdefault(intention.hand, message.t - ends)
    assert set(back) == {"left", "right"}
    assert max(back.values()) <= 0.5


def test_what_is_malformed_is_counted_and_the_rest_goes_on(ycb):
    lines = [message.to_json() for message in person(ycb, 3.0)]
    lines[10:10] = [b"{", b'{"t": "now"}', b"[" * 5000, b" " * 400_000, b"\xff"]
    done = subprocess.run(
        [sys.executable, "-m", "igrip", "stream", "--in", "stdin", "--out", "stdout"],
        input=b"\n".join(lines), capture_output=True, check=True,
    )  # fmt: skip
    assert b"4 malformed" in done.stderr
    assert len(done.stdout.splitlines()) == 2 * 90


def test_an_unassisted_hand_never_gets_a_lease(ycb):
    observer, intentions = watched(person(ycb, 40.0), "--assisted", "right")
    assert observer.violations == []
    assert any(i["commitment"] for i in intentions if i["hand"] == "right")
    assert not any(i["commitment"] for i in intentions if i["hand"] == "left")


@pytest.mark.parametrize(
    "blind", [{"jump_distance": 1e6}, {"frozen_after": 1e6}, {"max_object_age": 1e6}]
)
def test_the_observer_sees_what_health_is_for(ycb, blind):
    """Without one of its rules, leases break promises, and the observer says so."""
    faults = [Fault("jump", rate=0.4, lasts=0.25), Fault("freeze", rate=0.1, lasts=1.2)]
    config = igrip.Config(targets="paper", gating=blind, commitment={"reliability": 0.0})
    estimator, observer = igrip.Estimator(ycb, config), Observer(jumps=True)
    for message in inject(person(ycb, 300.0, 3), faults, seed=3):
        plain = json.loads(message.to_json())
        if "max_object_age" in blind and message.t > 1.0:
            plain["objects"] = {}  # told once, and never again
        observer.sent(plain)
        for intention in estimator.update(igrip.Observation(**plain)):
            observer.said(json.loads(intention.to_json()))
    assert observer.violations
