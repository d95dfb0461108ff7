"""The messages of an ``.mcap`` recording, with its own two types: events and detections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from igrip.entities import ObjectPose
from igrip.intention import Intention
from igrip.observation import Observation

OBSERVATIONS, INTENTIONS = "/observations", "/intentions"
EVENTS, DETECTIONS = "/events", "/detections"


class _Message(msgspec.Struct, frozen=True, kw_only=True):
    def to_json(self) -> bytes:
        """Return one line of JSON, without a line break."""
        return msgspec.json.encode(self)


class Event(_Message, frozen=True, kw_only=True):
    """Something that happened: a camera that stopped, a button, a trial that began.

    Parameters
    ----------
    t : float
        Its time on the clock of the messages [s].
    name : str
        Its name.
    data : dict, optional
        Further data, of JSON's types.
    """

    t: float
    name: str
    data: dict[str, Any] = {}


class DetectedHand(msgspec.Struct, frozen=True, kw_only=True):
    """A hand detected in a picture.

    Parameters
    ----------
    landmarks : list of 2 floats
        In the picture [pixels], in the detector's order.
    score : float
        The detector's confidence, 0 to 1.
    label : str or None
        The detected handedness, ``left`` or ``right``.
    """

    landmarks: list[tuple[float, float]]
    score: float
    label: str | None = None


class Detections(_Message, frozen=True, kw_only=True):
    """The hands and objects detected in one frame of one camera.

    Parameters
    ----------
    t : float
        Time of exposure of the frame [s].
    camera : str
        Name of the camera.
    hands : list of DetectedHand
        With the highest score first.
    objects : dict
        Poses in the world frame by id; None: looked for and not detected.
    """

    t: float
    camera: str
    hands: list[DetectedHand] = []
    objects: dict[str, ObjectPose | None] = {}


Message = Observation | Intention | Event | Detections

_TOPICS: Mapping[type[Any], str] = {
    Observation: OBSERVATIONS,
    Intention: INTENTIONS,
    Event: EVENTS,
    Detections: DETECTIONS,
}


def topic_of(message: Message) -> str:
    """Return the topic of a message."""
    return _TOPICS[type(message)]


def schema_of(topic: str) -> tuple[str, bytes]:
    """Return the name and the JSON schema of the messages of a topic.

    The schema has ``"type": "object"`` at its root, as Foxglove and other readers require, not only
    behind a reference.
    """
    kind = next(kind for kind, name in _TOPICS.items() if name == topic)
    # an Observation is no struct and makes its own schema
    schema = kind.json_schema() if kind is Observation else msgspec.json.schema(kind)
    root = schema["$defs"][schema["$ref"].rpartition("/")[2]]
    return f"igrip.{kind.__name__}", msgspec.json.encode({**root, "$defs": schema["$defs"]})
