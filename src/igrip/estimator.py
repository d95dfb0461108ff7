"""The loop: from an observation to the intention of each hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from igrip.commitment import Committer, Evidence, moving_along
from igrip.config import Config
from igrip.cues import CUES
from igrip.errors import IgripError
from igrip.geometry.scene import Geometry, PlacedObject, Scene
from igrip.grips import GRIPS, Grip
from igrip.intention import Intention, Status
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import Motion
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets import TARGETS, Scores, TargetEstimate, TargetsEstimator
from igrip.tracking import Tracker, TrustedObjects


class Estimator:
    """Says which object each hand will grasp, and with which grip.

    Parameters
    ----------
    catalog : Catalog
        The objects that may be there (:func:`igrip.load_objects`).
    config : Config, optional
        All parameters.

    Raises
    ------
    UnknownNameError
        If the configuration names a targets estimator or grip selector that does not exist.

    Examples
    --------
    >>> import igrip
    >>> estimator = igrip.Estimator(igrip.load_objects("ycb"))
    >>> seen = igrip.Observation(t=0.0, hands={"right": {"position": [0, 0, 0]}})
    >>> estimator.update(seen)[0].status
    'warming_up'
    """

    def __init__(self, catalog: Catalog, config: Config | None = None) -> None:
        if not isinstance(catalog, Mapping):
            raise TypeError(f"expected a catalogue (igrip.load_objects), got {catalog!r:.80}")
        self.config = config = config or Config()
        self._world = Tracker(
            catalog, config.tracking, config.motion, config.objects, config.gating
        )
        self._scene = Scene(config.rays)
        self._cues = [CUES.get(name) for name in CUES.names()]  # the paper's four, and yours
        self._new_targets = TARGETS.get(config.targets)
        self._new_targets()  # what it needs from files must fail here, not in mid-stream
        self._grips = GRIPS.get(config.grips)(config.grip)
        self._targets: dict[str, tuple[HandTrack, int, TargetsEstimator]] = {}
        self._committers: dict[str, Committer] = {}
        self._evidence: dict[str, Evidence] = {}
        self._seen = TrustedObjects(self._world)
        self._rejected_hands: set[str] = set()
        self._latest: dict[str, Intention] = {}

    def update(self, observation: Observation) -> list[Intention]:
        """Take one message.

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
        measured = self._world.take(observation)  # health, motion
        objects = self._world.placed()
        ready = [hand for hand in measured if hand.status in ("idle", "reaching")]
        motions = [hand.motion for hand in ready if hand.motion is not None]
        trouble = self._world.trouble()
        intentions = {}
        self._evidence.clear()
        self._rejected_hands.clear()
        for hand, motion, geometry in zip(
            ready, motions, self._scene.measure(motions, objects), strict=True
        ):
            cues = {cue.name: cue.score(motion, geometry, self.config.cues) for cue in self._cues}
            belief = self._targets_of(hand).update(motion, geometry, cues)
            grip = self._grips.select(belief, geometry, motion)
            said = self._intention(hand, geometry, cues, belief, grip, trouble)
            intentions[hand.id] = self._committed(hand, motion, geometry, said)
        return self._complete(intentions, measured)

    def veto(self, hand: str | None = None) -> list[Intention]:
        """End the lease of a hand, or of all; it gets none before it has rested.

        Returns
        -------
        list of Intention
            What is to be told at once: the newest intentions, without a lease.

        Raises
        ------
        IgripError
            If no device assists that hand.
        """
        return self._word(hand, Committer.veto)

    def confirm(self, hand: str | None = None) -> list[Intention]:
        """Take the user's word that the reach under way is meant: no dwell. As :meth:`veto`."""
        return self._word(hand, Committer.confirm)

    def notify_released(self, hand: str | None = None) -> list[Intention]:
        """Note that the device has opened: the hand holds nothing. As :meth:`veto`."""
        return self._word(hand, Committer.notify_released)

    def _word(self, hand: str | None, word: Callable[[Committer], None]) -> list[Intention]:
        if hand is not None and not self.config.commitment.assists(hand):
            raise IgripError(f"hand {hand!r:.80} is not one that a device assists")
        if hand is not None and hand not in self._committers:
            unknown = self._committers.keys() - self._world.hands.keys()
            is_followed = hand in self._world.hands
            if not is_followed and len(unknown) >= 4 * self.config.tracking.max_hands:
                raise IgripError(f"hand {hand!r:.80} is not known, and there are too many")
            self._committers[hand] = Committer(self.config.commitment)
        told = []
        for id in [hand] if hand is not None else list(self._committers):
            committer = self._committers[id]
            word(committer)
            before = self._latest.get(id)
            if before is None or committer.state in ("committed", "holding"):
                continue
            status = self._status(self._world.hands[id])
            self._latest[id] = msgspec.structs.replace(before, status=status, commitment=None)
            told.append(self._latest[id])
        return told

    @property
    def evidence(self) -> dict[str, Evidence]:
        """What commitment was decided on in the newest message, by hand (assisted or not)."""
        return dict(self._evidence)

    @property
    def rejected_hands(self) -> set[str]:
        """Hands whose measurement in the newest message could not be believed."""
        return set(self._rejected_hands)

    @property
    def objects(self) -> list[PlacedObject]:
        """The objects that can be used now, with their filtered poses."""
        return self._world.placed()

    @property
    def hands(self) -> dict[str, HandTrack]:
        """The hands that are followed, by id; to be read, not written."""
        return dict(self._world.hands)

    @property
    def t(self) -> float:
        """Time of the newest message [s]."""
        return self._world.t

    @property
    def latest(self) -> dict[str, Intention]:
        """The newest intention of each hand that is followed, by id; some from earlier messages."""
        return dict(self._latest)

    @property
    def scene(self) -> Scene:
        """The geometry, to draw its rays and count its work."""
        return self._scene

    def inputs(self) -> dict[str, Any]:
        """Return status, reason, age and counts of every hand and object, as plain data."""
        return self._world.report()

    def _targets_of(self, hand: HandTrack) -> TargetsEstimator:
        """Return the estimator of a hand; a new one where the hand's stream began anew."""
        restarts = hand.gate.counts["restarts"]
        known = self._targets.get(hand.id)
        if known is None or known[0] is not hand or known[1] != restarts:
            known = self._targets[hand.id] = (hand, restarts, self._new_targets())
        return known[2]

    def _intention(
        self,
        hand: HandTrack,
        geometry: Geometry,
        cues: dict[str, Scores],
        belief: TargetEstimate,
        grip: Grip,
        trouble: str | None,
    ) -> Intention:
        """Put one hand's result into words and numbers."""
        assert hand.motion is not None
        ids = [placed.id for placed in geometry.objects]
        age = self._world.t - hand.motion.t
        target = None if belief.target is None else geometry.objects[belief.target]
        contact = None if target is None else self._scene.contact(hand.motion, target)
        names = (*cues, "global")
        rows = zip(*(column.tolist() for column in (*cues.values(), belief.scores)), strict=True)
        scores = {id: dict(zip(names, row, strict=True)) for id, row in zip(ids, rows, strict=True)}
        probability = None
        if belief.probability is not None:
            probability = dict(zip([*ids, "none"], map(float, belief.probability), strict=True))
        return Intention(
            t=self._world.t,
            hand=hand.id,
            status=hand.status,
            reason=hand.reason(self._world.t) or trouble,
            target=target.id if target else None,
            target_model=target.model.name if target else None,
            confidence=None if belief.target is None else float(belief.scores[belief.target]),
            grip=grip.name,
            grip_probability=None if grip.probability is None else dict(grip.probability),
            time_to_contact=max(0.0, contact[0] - age) if contact else None,
            contact=contact[1] if contact else None,
            probability=probability,
            scores=scores,
        )

    def _committed(
        self, hand: HandTrack, motion: Motion, geometry: Geometry, said: Intention
    ) -> Intention:
        """Return the intention with its lease, if there is one."""
        moving = {p.id: v for p in geometry.objects if any(v := p.velocity.tolist())}
        evidence = self._evidence[hand.id] = Evidence(
            t=self._world.t,
            measured=motion.t,
            position=tuple(motion.position.tolist()),
            trusted=hand.trusted,
            moving=motion.reach.moving,
            target=said.target,
            grip=said.grip,
            confidence=said.probability or {id: row["global"] for id, row in said.scores.items()},
            seen=self._seen,
            gaps=dict(zip(said.scores, geometry.vertex.tolist(), strict=True)),
            carried=moving_along(moving, motion.velocity.tolist()) if moving else (),
        )
        if not self.config.commitment.assists(hand.id):
            return said
        committer = self._committers.get(hand.id)
        if committer is None:
            committer = self._committers[hand.id] = Committer(self.config.commitment)
        lease = committer.update(evidence)
        return msgspec.structs.replace(said, commitment=lease, status=self._status(hand))

    def _status(self, hand: HandTrack) -> Status:
        """Return what a hand does; one that holds does so whether it rests or moves."""
        committer = self._committers.get(hand.id)
        holds = committer is not None and committer.state == "holding"
        return "holding" if holds and hand.status in ("idle", "reaching") else hand.status

    def _complete(
        self, answered: dict[str, Intention], measured: list[HandTrack]
    ) -> list[Intention]:
        """Add the hands without an answer that were measured or whose status changed."""
        now = self._world.t
        for id in self._latest.keys() - self._world.hands.keys():  # forgotten by the world
            del self._latest[id]
            self._targets.pop(id, None)
            if id in self._committers and not self._committers[id].vetoed:
                del self._committers[id]
        for id, hand in self._world.hands.items():
            if id in answered:
                continue
            before, status = self._latest.get(id), self._status(hand)
            changed = before is None or status != before.status
            if hand in measured:
                self._rejected_hands.add(id)
                if id in self._committers:
                    self._committers[id].doubt()
            if changed or hand in measured:
                answered[id] = Intention(t=now, hand=id, status=status, reason=hand.reason(now))
        self._latest.update(answered)
        return [answered[id] for id in sorted(answered)]
