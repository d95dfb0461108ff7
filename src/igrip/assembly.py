"""Assembly of intentions, and of the evidence for commitments, from the results of the stages."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import NamedTuple

from igrip.entities import Vector
from igrip.evidence import Evidence, carried_objects
from igrip.geometry.scene import Geometry
from igrip.grips import Grip
from igrip.intention import Intention
from igrip.motion.hand_track import HandTrack
from igrip.motion.trajectory import Motion
from igrip.targets import Scores, TargetEstimate
from igrip.targets.learned.timing import Timing


class HandResults(NamedTuple):
    """The results of the stages for one hand.

    Attributes
    ----------
    hand, motion : HandTrack, Motion
        The hand.
    geometry : Geometry
        The hand against every object.
    cues : mapping of str to (o,) array
        Scores of each cue.
    estimate : TargetEstimate
        Of the target.
    grip : Grip
        For that target.
    contact : (float, 3 floats) or None
        Extrapolated contact with it: seconds from the newest sample, and the point [m].
    timing : Timing or None
        Predicted times of contact and of the end of the movement, from the newest sample.
    """

    hand: HandTrack
    motion: Motion
    geometry: Geometry
    cues: Mapping[str, Scores]
    estimate: TargetEstimate
    grip: Grip
    contact: tuple[float, Vector] | None
    timing: Timing | None


def build_intention(t: float, results: HandResults, object_problems: str | None) -> Intention:
    """Return the intention of a hand, without a commitment.

    Parameters
    ----------
    t : float
        Time of the message [s].
    results : HandResults
        Of that message.
    object_problems : str or None
        What is wrong with the input of objects: the reason, if the hand has none of its own.
    """
    hand, motion, geometry, cues, estimate, grip, contact, timing = results
    ids = [placed.id for placed in geometry.objects]
    target = None if estimate.target is None else geometry.objects[estimate.target]
    names = (*cues, "global")
    rows = zip(*(column.tolist() for column in (*cues.values(), estimate.scores)), strict=True)
    probability = None
    if estimate.probability is not None:
        probability = dict(zip([*ids, "none"], estimate.probability.tolist(), strict=True))
    age, grasp = t - motion.t, grip.grasp
    until_contact, until_end = (p.after(age) for p in timing) if timing else (None, None)
    return Intention(
        t=t,
        hand=hand.id,
        status=hand.status,
        reason=hand.reason(t) or object_problems,
        target=target.id if target else None,
        target_model=target.model.name if target else None,
        confidence=None if estimate.target is None else float(estimate.scores[estimate.target]),
        grip=grip.name,
        grip_probability=None if grip.probability is None else dict(grip.probability),
        time_to_contact=until_contact.median if until_contact else None,
        time_to_contact_interval=until_contact.interval if until_contact else None,
        time_to_end=until_end.median if until_end else None,
        time_to_end_interval=until_end.interval if until_end else None,
        contact=grasp.contact if grasp else contact[1] if contact else None,
        aperture=grasp.aperture if grasp else None,
        wrist=grasp.wrist if grasp else None,
        wrist_std=grasp.wrist_std if grasp else None,
        probability=probability,
        familiarity=estimate.familiarity,
        scores={id: dict(zip(names, row, strict=True)) for id, row in zip(ids, rows, strict=True)},
    )


def build_evidence(
    results: HandResults, intention: Intention, trusted_objects: Container[str]
) -> Evidence:
    """Return what a commitment for a hand is decided on."""
    hand, motion, geometry = results.hand, results.motion, results.geometry
    moving = {p.id: v for p in geometry.objects if any(v := p.velocity.tolist())}
    x, y, z = motion.position.tolist()
    return Evidence(
        t=intention.t,
        measured=motion.t,
        position=(x, y, z),
        trusted=hand.trusted,
        moving=motion.reach.moving,
        target=intention.target,
        grip=intention.grip,
        confidence=intention.probability
        or {id: row["global"] for id, row in intention.scores.items()},
        trusted_objects=trusted_objects,
        distances=dict(zip(intention.scores, geometry.vertex.tolist(), strict=True)),
        carried=carried_objects(moving, motion.velocity.tolist()) if moving else (),
        familiarity=intention.familiarity,
    )
