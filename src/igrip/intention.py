"""The result for one hand: its status, target, grip, confidence and time to contact."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from igrip.entities import Vector
from igrip.errors import ObservationError
from igrip.observation import SCHEMA

GRASP_FIELDS = ("aperture", "wrist", "wrist_std")
Status = Literal["warming_up", "idle", "reaching", "holding", "lost", "invalid"]


class Commitment(msgspec.Struct, frozen=True, kw_only=True):
    """A lease: permission to *start* an action, until ``valid_until`` and not longer.

    Parameters
    ----------
    target, grip : str
        What the action is for.
    since, valid_until : float
        When it was first given and when it ends, on the clock of the messages [s].
    """

    target: str
    grip: str
    since: float
    valid_until: float


class Intention(msgspec.Struct, frozen=True, kw_only=True):
    """The state of one hand after one message.

    Parameters
    ----------
    t : float
        Time of the message that led to it [s].
    hand : str
        Id of the hand.
    status : str
        ``warming_up``, ``idle``, ``reaching``, ``holding``, ``lost`` or ``invalid``.
    reason : str or None
        Why there is no estimate, or what is wrong with an input, as text.
    target, target_model : str or None
        Id of the object the hand is going for, and its model. None: no decision. Where there are
        probabilities, it is the likeliest object, even if ``none`` is somewhat likelier still.
    confidence : float or None
        The estimator's score of that target; its probability where there are any.
    grip : str or None
        The grip for the target: ``palmar`` or ``pinch``; with the grip selector ``candidates`` any
        of :data:`igrip.taxonomy.NAMES`.
    grip_probability : dict or None
        Probability of each grip, if the hand grasps; None for a rule that has none.
    time_to_contact : float or None
        Seconds from ``t`` until the palm is within 8 cm of the target's surface (predicted median);
        None: no target, or the hand rests.
    time_to_contact_interval : 2 floats or None
        It lies between these in 80 % of cases [s].
    time_to_end, time_to_end_interval : as these
        Until the movement ends.
    contact : 3 floats or None
        Where on the target's surface that is, world frame [m]; with ``candidates``, midway between
        thumb and fingers.
    aperture : float or None
        Predicted opening between thumb and fingers at contact [m]. This and the next two are given
        by the grip selector ``candidates`` alone, and else left out of messages.
    wrist : float or None
        Predicted rotation of the hand about its approach [rad], from -π/2 to π/2: 0 where thumb and
        fingers lie beside one another, level and across the way of the reach; positive
        anticlockwise as seen from in front of the palm.
    wrist_std : float or None
        Its standard deviation [rad].
    probability : dict or None
        Probability of each object and of ``none``; None for estimators that are not calibrated.
    familiarity : float or None
        How like the movements that the estimator learned from this one is, from 0 (strange) to 1;
        None: it learned from none, or the hand rests.
    scores : dict
        For each object, the score of each cue and the ``global`` one, by which the target was
        chosen (for a single: that cue's own).
    commitment : Commitment or None
        Permission to act. None: none.
    """

    t: float
    hand: str
    status: Status
    reason: str | None = None
    target: str | None = None
    target_model: str | None = None
    confidence: float | None = None
    grip: str | None = None
    grip_probability: dict[str, float] | None = None
    time_to_contact: float | None = None
    time_to_contact_interval: tuple[float, float] | None = None
    time_to_end: float | None = None
    time_to_end_interval: tuple[float, float] | None = None
    contact: Vector | None = None
    aperture: float | None = None
    wrist: float | None = None
    wrist_std: float | None = None
    probability: dict[str, float] | None = None
    familiarity: float | None = None
    scores: dict[str, dict[str, float]] = {}
    commitment: Commitment | None = None
    schema: Literal["igrip/1"] = SCHEMA

    def to_dict(self) -> dict[str, Any]:
        """Return plain dictionaries, lists and numbers."""
        message: dict[str, Any] = msgspec.to_builtins(self)
        if self.aperture is None:  # messages of other selectors stay as they were
            for name in GRASP_FIELDS:
                del message[name]
        return {"schema": message.pop("schema"), **message}

    def to_json(self) -> bytes:
        """Return one line of JSON, without a line break."""
        return msgspec.json.encode(self.to_dict())

    @classmethod
    def from_json(cls, line: bytes | str) -> Intention:
        """Read what :meth:`to_json` wrote.

        Raises
        ------
        ObservationError
            If the text is not an intention.
        """
        try:
            return msgspec.json.decode(line, type=cls)
        except msgspec.MsgspecError as error:
            raise ObservationError("intention", str(error)) from None

    @staticmethod
    def json_schema() -> dict[str, Any]:
        """Return the JSON schema of an intention."""
        return msgspec.json.schema(Intention)
