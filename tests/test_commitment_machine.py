"""Leases in any order of events: a state machine that tries to make one break its promises."""

from __future__ import annotations

import math

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    rule,
    run_state_machine_as_test,
)

import igrip
from igrip.commitment import CommitmentConfig
from igrip.errors import IgripError
from observer import Observer
from support import BOX, CAN, UPRIGHT

DT = 1.0 / 30.0
PLACES = {"box": (0.3, 0.0, 0.0), "can": (0.0, 0.35, 0.0)}
MODELS = {"box": BOX, "can": CAN}
HANDS = ("left", "right")
leases_given = []


class Leases(RuleBasedStateMachine):
    """Two hands, two objects, and everything that can happen to them."""

    catalog = None

    @initialize(
        reliability=st.sampled_from([0.0, 0.3]), assisted=st.sampled_from([("*",), ("right",)])
    )
    def begin(self, reliability, assisted):
        commitment = CommitmentConfig(reliability=reliability, assisted=assisted)
        config = igrip.Config(targets="distance", commitment=commitment)
        self.estimator = igrip.Estimator(self.catalog, config)
        self.assisted = HANDS if assisted == ("*",) else assisted
        self.observer, self.t, self.clock, self.swapped = Observer(), 1.0, 0.0, False
        self.frozen, self.vanished, self.vetoed, self.rested = False, set(), set(), {}
        self.at = {"left": [-0.2, 0.0, 0.0], "right": [0.0, 0.0, 0.0]}
        self.goal = dict.fromkeys(HANDS)
        self.send(objects=True)

    def send(self, hands=True, objects=False, times=1):
        for _ in range(times):
            self.t += DT
            self.move()
            message = {"t": self.t, "hands": {}, "objects": {}}
            if hands:
                order = HANDS[::-1] if self.swapped else HANDS
                for name, id in zip(order, HANDS, strict=True):
                    message["hands"][name] = {
                        "position": list(self.at[id]), "t": self.t + self.clock
                    }  # fmt: skip
            if objects:
                for id, place in PLACES.items():
                    message["objects"][id] = None if id in self.vanished else {
                        "model": MODELS[id], "position": list(place), "orientation": UPRIGHT,
                    }  # fmt: skip
            self.observer.sent(message)
            for intention in self.estimator.update(igrip.Observation(**message)):
                said = intention.to_dict()
                self.observer.said(said)
                if said["commitment"]:
                    leases_given.append(said["hand"])
                    assert said["hand"] in self.assisted
                    assert said["hand"] not in self.vetoed
                hand = said["hand"]
                if said["status"] == "idle" and hand in self.vetoed:
                    self.rested[hand] += DT
                    if self.rested[hand] > 0.25:
                        self.vetoed.discard(hand)

    def move(self):
        if self.frozen:
            return
        for id, goal in self.goal.items():
            target = self.at[id] if goal is None else PLACES[goal]
            step = [g - p for g, p in zip(target, self.at[id], strict=True)]
            far = math.dist(target, self.at[id])
            for axis in range(3):
                towards = step[axis] / far * min(0.02, far - 0.05) if far > 0.06 else 0.0
                wobble = 1e-4 * math.sin(37.0 * self.t + axis + len(id))
                self.at[id][axis] += towards + wobble

    @rule(times=st.integers(1, 12), objects=st.booleans())
    def observe(self, times, objects):
        self.send(objects=objects, times=times)

    @rule(hand=st.sampled_from(HANDS), goal=st.sampled_from([*PLACES, None]))
    def aim(self, hand, goal):
        self.goal[hand] = goal
        self.send(objects=True, times=12)

    @rule(hand=st.sampled_from(HANDS), goal=st.sampled_from(list(PLACES)))
    def reach_in_peace(self, hand, goal):
        self.clock, self.swapped, self.frozen = 0.0, False, False
        self.vanished.clear()
        self.goal = dict.fromkeys(HANDS)
        self.at = {"left": [-0.2, 0.0, 0.0], "right": [0.0, 0.0, 0.0]}
        self.send(objects=True, times=24)  # seen to be there, and at rest
        self.goal[hand] = goal
        self.send(objects=True, times=10)

    @rule(times=st.integers(1, 8))
    def tick(self, times):
        self.send(hands=False, times=times)

    @rule(seconds=st.floats(0.01, 3.0))
    def drop(self, seconds):
        self.t += seconds

    @rule()
    def swap(self):
        self.swapped = not self.swapped
        self.send(times=3)

    @rule(frozen=st.booleans())
    def freeze(self, frozen):
        self.frozen = frozen
        self.send(times=24)

    @rule(hand=st.sampled_from(HANDS), metres=st.sampled_from([0.05, 0.3, 2.0]))
    def jump(self, hand, metres):
        self.at[hand][2] += metres
        self.send(times=2)

    @rule(seconds=st.sampled_from([-1.0, -0.2, -0.12, 0.0, 0.04, 1.0]))
    def clock_step(self, seconds):
        self.clock = seconds
        self.send(times=4)

    @rule(id=st.sampled_from(list(PLACES)))
    def vanish(self, id):
        self.vanished.add(id)
        self.send(objects=True)

    @rule()
    def reappear(self):
        self.vanished.clear()
        self.send(objects=True)

    @rule(hand=st.sampled_from(HANDS))
    def veto(self, hand):
        if hand not in self.assisted:
            with pytest.raises(IgripError):
                self.estimator.veto(hand)
            return
        self.estimator.veto(hand)
        self.vetoed.add(hand)
        self.rested[hand] = 0.0
        self.send(objects=True, times=3)

    @rule(hand=st.sampled_from(HANDS), word=st.sampled_from(["confirm", "notify_released"]))
    def word(self, hand, word):
        if hand in self.assisted:
            getattr(self.estimator, word)(hand)
        self.send(times=2)

    @invariant()
    def no_promise_is_broken(self):
        if hasattr(self, "observer"):
            assert self.observer.violations == []


@pytest.mark.timeout(600)
def test_no_order_of_events_breaks_a_promise(shapes):
    Leases.catalog = shapes
    leases_given.clear()
    run_state_machine_as_test(
        Leases,
        settings=settings(
            max_examples=120, stateful_step_count=50, deadline=None,
            suppress_health_check=list(HealthCheck),
        ),
    )  # fmt: skip
    assert len(leases_given) > 100
