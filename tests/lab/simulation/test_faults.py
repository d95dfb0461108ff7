"""Sensors that go wrong: when, how, and never with a malformed message."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import pytest

from igrip.errors import IgripError
from igrip.lab.simulation.faults import KINDS, Fault, inject
from igrip.observation import Observation
from support import every_kind

POSE = {"model": "cup", "orientation": [0.0, 0.0, 0.0, 1.0]}


def source(seconds=6.0, rate=30.0):
    """Yield a hand on a line, another at rest, and two objects."""
    for k in range(int(seconds * rate)):
        yield Observation(
            t=1.0 + k / rate,
            hands={"left": {"position": [0.0, 0.0, 1.0]}, "right": {"position": [0.01 * k, 0, 0]}},
            objects={"a": POSE | {"position": [0, 1, 0]}, "b": POSE | {"position": [1, 1, 0]}},
        )


def during(kind, seed=0):
    """Return the messages of a fault from 3 to 4 s, and those that went in then."""
    changed = list(inject(source(), [Fault(kind, at=3.0, lasts=1.0)], seed))
    return [m for m in changed if 3.05 < m.t < 3.95], [m for m in source() if 3.05 < m.t < 3.95]


def test_outside_of_the_fault_nothing_is_changed():
    for kind in KINDS:
        changed = list(inject(source(), [Fault(kind, at=3.0, lasts=1.0)], 1))
        whole = {m.t: m for m in source()}
        before = [m for m in changed if m.t < 3.0]
        after = [m for m in changed if m.t > 4.8]
        assert len(before) == 60
        assert len(after) >= 50
        assert all(whole[m.t] == m for m in before + after)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_times_never_decrease_and_a_seed_repeats_it(kind):
    faults = [Fault(kind, rate=0.7, lasts=0.6), Fault("delay", rate=0.2, lasts=0.4)]
    one = list(inject(source(30.0), faults, seed=5))
    assert all(a.t <= b.t for a, b in pairwise(one))
    assert one == list(inject(source(30.0), faults, seed=5))
    assert one != list(inject(source(30.0), faults, seed=6))


def test_drop_leaves_ticks():
    changed, _ = during("drop")
    assert changed
    assert all(m.is_tick for m in changed)
    assert max(b.t - a.t for a, b in pairwise(changed)) < 0.08


def test_freeze_repeats_the_last_bit():
    changed, _ = during("freeze")
    assert len({m.hands["right"].position for m in changed}) == 1
    assert len({m.t for m in changed}) == len(changed)


def test_jump_moves_hands_by_one_step():
    changed, plain = during("jump")
    steps = {
        tuple(round(a - b, 6) for a, b in zip(m.hands["right"].position, p.hands["right"].position,
                                              strict=True))
        for m, p in zip(changed, plain, strict=True)
    }  # fmt: skip
    assert len(steps) == 1
    assert any(abs(x) > 0.01 for x in next(iter(steps)))


def test_swap_exchanges_hands_and_wrong_exchanges_objects():
    changed, plain = during("swap")
    for m, p in zip(changed, plain, strict=True):
        assert (m.hands["left"], m.hands["right"]) == (p.hands["right"], p.hands["left"])
    changed, plain = during("wrong")
    for m, p in zip(changed, plain, strict=True):
        assert m.objects["a"].position == p.objects["b"].position


def test_lose_and_vanish_say_that_nothing_was_seen():
    assert all(m.hands == {"left": None, "right": None} for m in during("lose")[0])
    assert all(m.objects == {"a": None, "b": None} for m in during("vanish")[0])


@pytest.mark.parametrize(("kind", "shift"), [("stale", -1.0), ("future", 1.0)])
def test_times_of_measurement_are_off(kind, shift):
    assert all(m.hands["right"].t == pytest.approx(m.t + shift) for m in during(kind)[0])


def test_step_is_one_step():
    assert len({round(m.hands["right"].t - m.t, 6) for m in during("step")[0]}) == 1


def test_duplicate_sends_twice_and_loses_none():
    changed, plain = during("duplicate")
    assert changed == [m for m in plain for _ in range(2)]


@pytest.mark.parametrize("kind", ["delay", "reorder"])
def test_late_messages_are_not_lost(kind):
    changed = list(inject(source(), [Fault(kind, at=3.0, lasts=1.0)], 2))
    measured = [
        m.hands["right"].t if m.hands["right"].t is not None else m.t for m in changed if m.hands
    ]
    assert sorted(measured) == pytest.approx([m.t for m in source()])
    assert measured != sorted(measured)  # some that were sent later came earlier


def test_spells_are_counted_and_of_every_kind():
    counts = Counter()
    list(inject(source(200.0), every_kind(10.0), 0, counts))
    assert set(counts) == set(KINDS)
    assert 1200 < sum(counts.values()) < 2100  # 2,000 were to be, less those that overlap


@pytest.mark.parametrize(("text", "fault"), [
    ("freeze@3+0.5", Fault("freeze", 3.0, 0.5)),
    ("jump:0.2x0.1", Fault("jump", rate=0.2, lasts=0.1)),
])  # fmt: skip
def test_faults_are_told_in_words(text, fault):
    told = Fault.parse(text)
    assert (told.kind, told.lasts, told.rate) == (fault.kind, fault.lasts, fault.rate)
    assert told.at == fault.at or told.at != told.at


@pytest.mark.parametrize(
    "text", ["", "melt@1+1", "freeze", "freeze@1", "jump:", "jump:1.2.3", "drop@x+1"]
)
def test_what_is_no_fault_is_refused_and_says_what_is_one(text):
    with pytest.raises(IgripError, match="fault"):
        Fault.parse(text)
