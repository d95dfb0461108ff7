"""Intentions on the Lab Streaming Layer: what changes as markers, numbers as a signal.

Metadata follow the XDF specification's Markers and general channel descriptions, so that
LabRecorder, pyxdf and MNE-LSL read labels, units and types.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

from igrip.errors import MissingExtraError
from igrip.intention import Intention
from igrip.runtime.envelope import Envelope
from igrip.version import __version__

try:
    import pylsl
except (ImportError, RuntimeError):  # pylsl raises RuntimeError where liblsl is missing
    raise MissingExtraError("pylsl", "outputs", "Lab Streaming Layer") from None

HANDS = ("left", "right")
CHANNELS = (
    ("confidence", "normalized", "of the target, by the estimator"),
    ("none", "normalized", "probability that it is none of the objects"),
    ("time_to_contact", "seconds", "NaN: not within the horizon"),
    ("permitted_for", "seconds", "a device may start an action for so long; 0: not at all"),
)


class LslOutput:
    """Two outlets: ``NAME-markers`` (type Markers) and ``NAME`` (type Intention).

    Parameters
    ----------
    name : str
        Of the streams.
    session : str
        Told as part of the source id, so that a restart is another stream.
    hands : sequence of str
        The hands that have channels in the signal.
    """

    def __init__(self, name: str, session: str, hands: Sequence[str] = HANDS) -> None:
        self._hands = tuple(hands)
        self._markers = pylsl.StreamOutlet(_markers(name, session))
        self._signal = pylsl.StreamOutlet(_signal(name, session, self._hands))
        self._numbers = {hand: [math.nan, math.nan, math.nan, 0.0] for hand in self._hands}
        self._told: dict[str, str] = {}
        self._sent = 0

    def send(self, envelope: Envelope) -> None:
        """Push the numbers, and a marker if anything changed; liblsl buffers and never waits."""
        intention = envelope.intention
        at = pylsl.local_clock() - max(0.0, time.monotonic() - envelope.arrived)
        told = envelope.to_dict()
        words = marker_of(told)
        if self._told.get(intention.hand) != words:
            self._told[intention.hand] = words
            self._markers.push_sample([words], at)
        if intention.hand in self._numbers:
            self._numbers[intention.hand] = numbers_of(intention, told["valid_for"])
            flat = [x for hand in self._hands for x in self._numbers[hand]]
            self._signal.push_sample(flat, at)
        self._sent += 1

    def counts(self) -> dict[str, int]:
        """Return how many intentions were pushed."""
        return {"sent": self._sent}

    def close(self) -> None:
        """End both streams."""
        del self._markers, self._signal


def marker_of(told: Mapping[str, Any]) -> str:
    """Return what is told when it changes, as JSON: ids may hold any characters."""
    lease = told["commitment"]
    marker = {key: told[key] for key in ("hand", "status", "target", "grip")}
    return json.dumps(marker | {"commitment": lease and lease["target"]}, ensure_ascii=False)


def numbers_of(intention: Intention, valid_for: float | None) -> list[float]:
    """Return the channels of one hand."""
    none = (intention.probability or {}).get("none", math.nan)
    return [
        math.nan if x is None else float(x)
        for x in (intention.confidence, none, intention.time_to_contact, valid_for or 0.0)
    ]


def _markers(name: str, session: str) -> pylsl.StreamInfo:
    info = pylsl.StreamInfo(
        f"{name}-markers", "Markers", 1, pylsl.IRREGULAR_RATE, "string", f"igrip-{session}-markers"
    )
    _describe(info)
    channel = info.desc().append_child("channels").append_child("channel")
    channel.append_child_value("label", "intention").append_child_value("type", "Marker")
    return info


def _signal(name: str, session: str, hands: Sequence[str]) -> pylsl.StreamInfo:
    info = pylsl.StreamInfo(
        name, "Intention", len(hands) * len(CHANNELS), pylsl.IRREGULAR_RATE, "float32",
        f"igrip-{session}",
    )  # fmt: skip
    _describe(info)
    channels = info.desc().append_child("channels")
    for hand in hands:
        for label, unit, meaning in CHANNELS:
            channel = channels.append_child("channel")
            channel.append_child_value("label", f"{hand}.{label}")
            channel.append_child_value("unit", unit).append_child_value("type", "Intention")
            channel.append_child_value("description", meaning)
    return info


def _describe(info: pylsl.StreamInfo) -> None:
    acquisition = info.desc().append_child("acquisition")
    acquisition.append_child_value("manufacturer", "igrip").append_child_value("model", "igrip")
    acquisition.append_child_value("software_version", __version__)
