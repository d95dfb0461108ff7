"""The estimator: from an observation to the intention of each hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from igrip.adaptation import Person
from igrip.assembly import HandResults, build_evidence, build_intention
from igrip.commitment import Committer
from igrip.config import Config
from igrip.cues import CUES
from igrip.errors import IgripError
from igrip.evidence import Evidence
from igrip.geometry.scene import Geometry, PlacedObject, Scene
from igrip.grips import GRIPS
from igrip.holding import Holding
from igrip.intention import Intention, Status
from igrip.joint_targets import JointTargets
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import Motion
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets import TARGETS, HandEstimate, Scores, TargetEstimate, TargetsEstimator
from igrip.targets.learned.timing import Timing, default_timing
from igrip.tracking import Tracker, TrustedObjects


class Estimator:
    """Estimates which object each hand will grasp, and with which grip.

    Parameters
    ----------
    catalog : Catalog
        The objects that may be there (:func:`igrip.load_objects`).
    config : Config, optional
        All parameters.
    person : Person, optional
        Whose hands they are: commitments adapt to their reaches (:mod:`igrip.adaptation`).

    Raises
    ------
    UnknownNameError
        If the configuration names a targets estimator or grip selector that does not exist.

    Examples
    --------
    >>> import igrip
    >>> estimator = igrip.Estimator(igrip.load_objects("ycb"))
    >>> observation = igrip.Observation(t=0.0, hands={"right": {"position": [0, 0, 0]}})
    >>> estimator.update(observation)[0].status
    'warming_up'
    """

    def __init__(
        self, catalog: Catalog, config: Config | None = None, person: Person | None = None
    ) -> None:
        if not isinstance(catalog, Mapping):
            raise TypeError(f"expected a catalogue (igrip.load_objects), got {catalog!r:.80}")
        self.config = config = config or Config()
        self._tracker = Tracker(
            catalog, config.tracking, config.motion, config.objects, config.gating
        )
        self._scene = Scene(config.rays)
        self._cues = [CUES.get(name) for name in CUES.names()]  # the paper's four, and yours
        self._new_targets = TARGETS.get(config.targets)
        self._new_targets()  # a missing or broken file must raise here, not in mid-stream
        self._grips = GRIPS.get(config.grips)(config.grip)
        self._timing_model = default_timing()
        self._targets: dict[str, tuple[HandTrack, int, TargetsEstimator]] = {}
        self._person = person
        self._committers: dict[str, Committer] = {}
        self._evidence: dict[str, Evidence] = {}
        self._joint = JointTargets(self._new_targets)
        self._holding = Holding(
            config.commitment.holding_distance, config.commitment.release_margin
        )
        self._trusted_objects = TrustedObjects(self._tracker)
        self._rejected_hands: set[str] = set()
        self._latest: dict[str, Intention] = {}

    def update(self, observation: Observation) -> list[Intention]:
        """Process one message.

        Parameters
        ----------
        observation : Observation
            Not older than the last.

        Returns
        -------
        list of Intention
            One for each hand that was measured in the message or whose status it changed, by id.

        Raises
        ------
        ObservationError
            If the message contradicts earlier ones (time decreases, an id changes its model);
            nothing is changed by it.
        """
        measured = self._tracker.update(observation)  # gating, tracking, motion
        objects, problems = self._tracker.placed_objects(), self._tracker.object_problems()
        hands = [(h, h.motion) for h in measured if h.motion is not None and h.is_followed]
        geometries = self._scene.measure([motion for _, motion in hands], objects)
        seen = [(hand, m, g) for (hand, m), g in zip(hands, geometries, strict=True)]
        intentions = {}
        self._evidence.clear()
        for (hand, motion, geometry), (cues, estimate) in zip(
            seen, self._estimate(seen, objects), strict=True
        ):
            grip = self._grips.select(estimate, geometry, motion)
            target = None if estimate.target is None else objects[estimate.target]
            contact = None if target is None else self._scene.contact(motion, target)
            timing = self._timing(motion, geometry, estimate)
            results = HandResults(hand, motion, geometry, cues, estimate, grip, contact, timing)
            intention = build_intention(self.t, results, problems)
            intentions[hand.id] = self._commit(results, intention)
        return self._complete(intentions, measured)

    def veto(self, hand: str | None = None) -> list[Intention]:
        """End the lease of a hand, or of all; it gets none before it has rested.

        Returns
        -------
        list of Intention
            To be sent at once: the newest intentions, without a lease.

        Raises
        ------
        IgripError
            If no device assists that hand.
        """
        return self._command(hand, Committer.veto)

    def confirm(self, hand: str | None = None) -> list[Intention]:
        """Confirm the present reach from outside: no dwell is needed. As :meth:`veto`."""
        return self._command(hand, Committer.confirm)

    def notify_released(self, hand: str | None = None) -> list[Intention]:
        """Report that the device has opened: the hand holds nothing. As :meth:`veto`."""
        return self._command(hand, Committer.notify_released)

    def _command(self, hand: str | None, command: Callable[[Committer], None]) -> list[Intention]:
        if hand is not None and not self.config.commitment.assists(hand):
            raise IgripError(f"hand {hand!r:.80} is not among the assisted hands")
        if hand is not None and hand not in self._committers:
            unknown = self._committers.keys() - self._tracker.hands.keys()
            is_followed = hand in self._tracker.hands
            if not is_followed and len(unknown) >= 4 * self.config.tracking.max_hands:
                raise IgripError(
                    f"hand {hand!r:.80} is not known, and the number of hands has reached its limit"
                )
            self._committers[hand] = Committer(self.config.commitment, self._person)
        intentions = []
        for id in [hand] if hand is not None else list(self._committers):
            committer = self._committers[id]
            command(committer)
            before = self._latest.get(id)
            if before is None or committer.state in ("committed", "holding"):
                continue
            status = self._status(self._tracker.hands[id])
            self._latest[id] = msgspec.structs.replace(before, status=status, commitment=None)
            intentions.append(self._latest[id])
        return intentions

    @property
    def evidence(self) -> dict[str, Evidence]:
        """What commitments were decided on in the newest message, by hand, assisted or not."""
        return dict(self._evidence)

    @property
    def rejected_hands(self) -> set[str]:
        """Hands whose measurement in the newest message was rejected or does not suffice yet."""
        return set(self._rejected_hands)

    @property
    def objects(self) -> list[PlacedObject]:
        """The objects that can be used now, with their filtered poses."""
        return self._tracker.placed_objects()

    @property
    def hands(self) -> dict[str, HandTrack]:
        """The hands that are followed, by id; to be read, not written."""
        return dict(self._tracker.hands)

    @property
    def t(self) -> float:
        """Time of the newest message [s]."""
        return self._tracker.t

    @property
    def latest(self) -> dict[str, Intention]:
        """The newest intention of each known hand, by id; some from earlier messages."""
        return dict(self._latest)

    @property
    def scene(self) -> Scene:
        """The geometry, to draw its rays and to count its work."""
        return self._scene

    def inputs(self) -> dict[str, Any]:
        """Return status, reason, age and counts of every hand and object, as plain data."""
        return self._tracker.summary()

    def _estimate(
        self, seen: list[tuple[HandTrack, Motion, Geometry]], objects: list[PlacedObject]
    ) -> list[tuple[dict[str, Scores], TargetEstimate]]:
        """Return cues and estimate of each hand; follow what hands hold, and who contends."""
        scores, own = [], []
        for hand, motion, geometry in seen:
            cues = {cue.name: cue.score(motion, geometry, self.config.cues) for cue in self._cues}
            estimate = self._targets_of(hand).update(motion, geometry, cues)
            scores.append(cues)
            own.append(HandEstimate(hand.id, motion, geometry, estimate))
        followed = [id for id, hand in self._tracker.hands.items() if hand.is_followed]
        self._holding.update(own, self._tracker.hands, followed)
        return list(zip(scores, self._joint.update(own, objects, followed), strict=True))

    def _targets_of(self, hand: HandTrack) -> TargetsEstimator:
        """Return the estimator of a hand, a new one after each restart of its stream."""
        restarts = hand.gate.counts["restarts"]
        known = self._targets.get(hand.id)
        if known is None or known[0] is not hand or known[1] != restarts:
            known = self._targets[hand.id] = (hand, restarts, self._new_targets())
        return known[2]

    def _timing(
        self, motion: Motion, geometry: Geometry, estimate: TargetEstimate
    ) -> Timing | None:
        """Return when the hand will be at its target; None for a resting hand."""
        if estimate.target is None or not motion.reach.may_move:
            return None
        return self._timing_model.predict(motion, geometry.cylinders().one(estimate.target))

    def _commit(self, results: HandResults, intention: Intention) -> Intention:
        """Return the intention with its lease, if there is one."""
        hand = results.hand
        evidence = build_evidence(results, intention, self._trusted_objects)
        if held := self._holding.by_others(hand.id):
            evidence = evidence._replace(held=held)
        self._evidence[hand.id] = evidence
        if not self.config.commitment.assists(hand.id):
            return intention
        committer = self._committers.get(hand.id)
        if committer is None:
            committer = self._committers[hand.id] = Committer(self.config.commitment, self._person)
        lease = committer.update(evidence)
        reason = intention.reason or (None if lease else committer.refused_because)
        return msgspec.structs.replace(
            intention, commitment=lease, status=self._status(hand), reason=reason
        )

    def _status(self, hand: HandTrack) -> Status:
        """Return the status of a hand; one that holds does so whether it rests or moves."""
        committer = self._committers.get(hand.id)
        holds = committer is not None and committer.state == "holding"
        return "holding" if holds and hand.is_followed else hand.status

    def _complete(
        self, intentions: dict[str, Intention], measured: list[HandTrack]
    ) -> list[Intention]:
        """Add the hands without a result that were measured or whose status changed."""
        t, hands = self.t, self._tracker.hands
        for id in self._latest.keys() - hands.keys():  # forgotten by the tracker
            del self._latest[id]
            self._targets.pop(id, None)
            if id in self._committers and not self._committers[id].vetoed:
                del self._committers[id]
        self._rejected_hands = {hand.id for hand in measured if hand.id not in intentions}
        for id in self._rejected_hands:
            if id in self._committers:
                self._committers[id].reject()
        for id, hand in hands.items():
            if id in intentions:
                continue
            before, status = self._latest.get(id), self._status(hand)
            if before is None or status != before.status or id in self._rejected_hands:
                reason = hand.reason(t)
                intentions[id] = Intention(t=t, hand=id, status=status, reason=reason)
        self._latest.update(intentions)
        return [intentions[id] for id in sorted(intentions)]
