"""Adaptation to a person: a threshold that follows from where their hand came to rest.

Adaptive conformal inference (Gibbs & Candès 2021, arXiv 2106.00170). After each reach the margin of
the threshold moves by ``step · (wrong - max_wrong)``: up a little more than it comes down, so that
in the long run wrong commitments are ``max_wrong`` of the reaches, whoever moves and however that
changes. Over T reaches in which the margin is not at a bound, the share of wrong ones differs from
``max_wrong`` by at most ``(max_rise + max_fall + step) / (step · T)``. The label is free: the
object at which the hand comes to rest. A commitment is wrong if it was for another, if the hand
comes to rest away from all of them, or if it is vetoed.
"""

from __future__ import annotations

import math

import msgspec

from igrip.evidence import Evidence
from igrip.settings import Settings, quantity


class AdaptationConfig(Settings):
    """How fast and how far the threshold follows a person."""

    max_wrong: float = quantity(
        0.03, "1", "accepted share of reaches with a wrong commitment: 5 % of the commitments if "
        "60 % of the reaches get one", "docs/commitment.md", gt=0, le=0.5,
    )  # fmt: skip
    step: float = quantity(
        0.05, "1", "the margin rises by nearly this much after a wrong commitment", "guess", gt=0,
        le=0.5,
    )  # fmt: skip
    max_fall: float = quantity(
        0.1, "1", "the threshold falls by no more than this", "guess", ge=0, lt=1
    )
    max_rise: float = quantity(
        0.3, "1", "the threshold rises by no more than this", "guess", ge=0, lt=1
    )
    rest_duration: float = quantity(
        0.3, "s", "a hand that rests this long has finished its reach", "guess", ge=0
    )


class Person(msgspec.Struct):
    """What is learned of a person. It can be read, kept, carried to another machine or deleted.

    Attributes
    ----------
    margin : float
        What is added to the threshold of each commitment.
    reaches, wrong : int
        Finished reaches that were learned from, and those with a wrong commitment.
    """

    margin: float = 0.0
    reaches: int = 0
    wrong: int = 0


class ReachLearner:
    """Learns from the reaches of one hand.

    Parameters
    ----------
    config : AdaptationConfig
        How fast and how far.
    person : Person
        Whose hand it is; changed after each reach. The hands of a person share it.
    holding_distance : float
        A palm that rests this near to an object has come to it [m].
    """

    def __init__(self, config: AdaptationConfig, person: Person, holding_distance: float) -> None:
        self.person = person
        self._config = config
        self._holding_distance = holding_distance
        self._begin()

    def _begin(self) -> None:
        self._moved = self._finished = False
        self._committed_to: str | None = None
        self._resting_since = math.nan

    def veto(self) -> None:
        """Learn that the commitment of this reach was not wanted."""
        if self._committed_to is not None and not self._finished:
            self._finish(wrong=True)

    def update(self, evidence: Evidence, committed_to: str | None) -> None:
        """Learn from a trusted measurement.

        Parameters
        ----------
        evidence : Evidence
            Of the hand.
        committed_to : str or None
            The object of its lease, if there is one.
        """
        if evidence.moving:
            if self._finished:
                self._begin()
            self._moved, self._resting_since = True, math.nan
            self._committed_to = self._committed_to or committed_to
            return
        if not self._moved or self._finished:
            return
        if math.isnan(self._resting_since):
            self._resting_since = evidence.measured
        if evidence.measured - self._resting_since < self._config.rest_duration:
            return
        reached = [
            id for id, distance in evidence.distances.items() if distance <= self._holding_distance
        ]
        if self._committed_to is not None:
            nearest = min(reached, key=evidence.distances.__getitem__, default=None)
            self._finish(wrong=self._committed_to != nearest)
        elif reached:
            self._finish(wrong=False)
        else:
            self._begin()  # a movement to nowhere teaches nothing

    def _finish(self, wrong: bool) -> None:
        config, person = self._config, self.person
        self._finished = True
        person.reaches += 1
        person.wrong += wrong
        margin = person.margin + config.step * (wrong - config.max_wrong)
        person.margin = min(max(margin, -config.max_fall), config.max_rise)
