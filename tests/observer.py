"""Checks leases from outside: reads what goes into a service and what comes out, nothing else."""

from __future__ import annotations

import itertools
import math

LEASE, OBJECT_AGE, FROZEN, TOLERANCE = 0.15, 2.0, 0.5, 0.05
JUMP, NEW_STREAM = 0.6, 0.3  # m from message to message no hand moves; s until it is another
LATENCY = 0.15  # s; poses of the demo are up to so old when they come
BELIEVED = ("idle", "reaching", "holding")


class Observer:
    """Collects violations of what docs/commitment.md promises."""

    def __init__(self, jumps=False):
        self._looks_for_jumps = jumps  # where nothing else goes wrong: late messages jump, too
        self.violations = []
        self.commitments = 0
        self.answers = 0
        self._t = 0.0
        self._jumped, self._together, self._missed = {}, set(), {}
        self._hands = {}  # id: (newest time that can be believed, position, same since)
        self._objects = {}  # id: (time, static) of the newest look; None if it was not seen

    def sent(self, message):
        """Take a message as it went in."""
        self._t = t = message["t"]
        for id, hand in message.get("hands", {}).items():
            if hand is None:
                continue
            own = hand.get("t", t)
            before = self._hands.get(id)
            if own > t + TOLERANCE or (before and own <= before[0]):
                continue
            position = tuple(hand["position"])
            followed = before and (own - before[0] < 0.12 or id in self._jumped)
            if self._looks_for_jumps and followed and math.dist(position, before[1]) > JUMP:
                self._jumped.setdefault(id, t)
                if t - self._jumped[id] < NEW_STREAM:
                    continue  # not believed; it may be another hand by now, if it stays
            self._jumped.pop(id, None)
            same = before[2] if before and before[1] == position else own
            self._hands[id] = (own, position, same)
        here = {id: hand[1] for id, hand in self._hands.items() if t - hand[0] < 0.3}
        self._together = {
            id for one, other in itertools.combinations(here, 2) for id in (one, other)
            if math.dist(here[one], here[other]) < 0.025
        }  # fmt: skip
        for id, pose in message.get("objects", {}).items():
            if pose is None:
                self._objects[id], self._missed[id] = None, t
            elif pose.get("t", t) <= self._missed.get(id, -1.0) - LATENCY:
                continue  # seen before it was missed, told after
            elif pose.get("t", t) <= t + TOLERANCE:
                newest = self._objects.get(id)
                own = pose.get("t", t)
                if newest is None or own > newest[0]:
                    self._objects[id] = (own, pose.get("static", False))

    def said(self, intention):
        """Take an intention as it came out, after the message that led to it went in."""
        self.answers += 1
        lease = intention["commitment"]
        if lease is None:
            return
        self.commitments += 1
        hand, t = intention["hand"], intention["t"]
        known = self._hands.get(hand)
        seen = self._objects.get(lease["target"])
        checks = {
            "the hand is not believed": intention["status"] in BELIEVED,
            "it has ended when it is given": lease["valid_until"] > t,
            "the hand was never measured": known is not None,
            "it outlives the newest measurement":
                known is None or lease["valid_until"] <= known[0] + LEASE + 1e-9,
            "the hand is frozen": known is None or known[0] - known[2] < FROZEN,
            "the target is absent": seen is not None,
            "the hand has jumped":
                hand not in self._jumped or t - self._jumped[hand] >= NEW_STREAM,
            "the hand is where another is": hand not in self._together,
            "the target was seen too long ago":
                seen is None or seen[1] or t - seen[0] <= OBJECT_AGE + 1e-9,
            "it began later than now": lease["since"] <= t,
        }  # fmt: skip
        for words, holds in checks.items():
            if not holds:
                self.violations.append(f"t={t:.3f} {hand}: {words}")
