"""Intentions on the Lab Streaming Layer: what changes as markers, numbers as a signal.

Metadata follow the XDF specification's Markers and general channel descriptions, so that
LabRecorder, pyxdf and MNE-LSL read labels, units and types.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from igrip.errors import requires_extra
from igrip.intention import Intention
from igrip.io.hand_ids import match_hand
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.version import __version__

# pylsl raises RuntimeError where liblsl is missing
with requires_extra("pylsl", "outputs", "Lab Streaming Layer", (ImportError, RuntimeError)):
    import pylsl

MAX_REMEMBERED = 256  # hands whose newest marker is remembered, however many ids come and go
CHANNELS = (
    ("confidence", "normalized", "of the target, by the estimator"),
    ("none", "normalized", "probability that it is none of the objects"),
    ("time_to_contact", "seconds", "NaN: not within the horizon"),
    ("permitted_for", "seconds", "a device may start an action for so long; 0: not at all"),
)


@OUTPUTS.register("lsl")
class LslOutput:
    """Two outlets: ``NAME-markers`` (type Markers) and ``NAME`` (type Intention).

    The session is part of the source ids, so that a restart is another stream.
    """

    def __init__(self, options: Options) -> None:
        self._name, self._hands = options.stream_name, options.hands
        self._numbers = {hand: [math.nan, math.nan, math.nan, 0.0] for hand in self._hands}
        self._last_markers: dict[str, str] = {}
        self._known: dict[str, str | None] = {}  # hands by the ids of intentions
        self._sent = 0

    def start(self, loop: Loop) -> None:
        """Open both outlets."""
        self._warn = loop.warn
        self._markers = pylsl.StreamOutlet(_markers(self._name, loop.session))
        self._signal = pylsl.StreamOutlet(_signal(self._name, loop.session, self._hands))

    def send(self, envelope: Envelope) -> None:
        """Push the numbers, and a marker if anything changed; liblsl buffers and never waits."""
        intention = envelope.intention
        now = pylsl.local_clock()
        message = envelope.to_dict()
        arrived = now - message["age"]
        marker = marker_of(message)
        if self._last_markers.get(intention.hand) != marker:
            self._last_markers.pop(intention.hand, None)
            self._last_markers[intention.hand] = marker
            if len(self._last_markers) > MAX_REMEMBERED:
                del self._last_markers[next(iter(self._last_markers))]
            self._markers.push_sample([marker], arrived)
        hand = self._channels_of(intention.hand)
        if hand is not None:
            self._numbers[hand] = numbers_of(intention, message["valid_for"])
            flat = [x for hand in self._hands for x in self._numbers[hand]]
            self._signal.push_sample(flat, arrived)
        self._sent += 1

    def _channels_of(self, hand: str) -> str | None:
        """Return the hand whose channels are those of an id, in whatever spelling; None: none."""
        if hand not in self._known:
            if len(self._known) >= MAX_REMEMBERED:
                del self._known[next(iter(self._known))]
            own = match_hand(hand, self._hands)
            if own == hand:  # two ids must not share channels
                self._known = {id: None if to == own else to for id, to in self._known.items()}
            self._known[hand] = None if own in self._known.values() else own
            if self._known[hand] is None:
                ids = ", ".join(self._hands)
                self._warn(f"lsl: hand {hand!r:.60} has no channels; there are those of {ids}")
        return self._known[hand]

    def counts(self) -> dict[str, int]:
        """Return how many intentions were pushed."""
        return {"sent": self._sent}

    def close(self) -> None:
        """Close both outlets."""
        self._markers = self._signal = None


def marker_of(message: Mapping[str, Any]) -> str:
    """Return what is sent when it changes, as JSON: ids may hold any characters."""
    lease = message["commitment"]
    marker = {key: message[key] for key in ("hand", "status", "target", "grip")}
    return json.dumps(marker | {"commitment": lease and lease["target"]}, ensure_ascii=False)


def numbers_of(intention: Intention, valid_for: float | None) -> list[float]:
    """Return the channels of one hand."""
    none = (intention.probability or {}).get("none", math.nan)
    return [
        math.nan if x is None else float(x)
        for x in (intention.confidence, none, intention.time_to_contact, valid_for or 0.0)
    ]


def _markers(name: str, session: str) -> pylsl.StreamInfo:
    channel = {"label": "intention", "type": "Marker"}
    return _info(f"{name}-markers", "Markers", "string", f"igrip-{session}-markers", [channel])


def _signal(name: str, session: str, hands: Sequence[str]) -> pylsl.StreamInfo:
    channels = [
        {"label": f"{hand}.{label}", "unit": unit, "type": "Intention", "description": meaning}
        for hand in hands for label, unit, meaning in CHANNELS
    ]  # fmt: skip
    return _info(name, "Intention", "float32", f"igrip-{session}", channels)


def _info(
    name: str, kind: str, form: str, source: str, channels: Sequence[Mapping[str, str]]
) -> pylsl.StreamInfo:
    info = pylsl.StreamInfo(name, kind, len(channels), pylsl.IRREGULAR_RATE, form, source)
    acquisition = info.desc().append_child("acquisition")
    acquisition.append_child_value("manufacturer", "igrip").append_child_value("model", "igrip")
    acquisition.append_child_value("software_version", __version__)
    described = info.desc().append_child("channels")
    for channel in channels:
        node = described.append_child("channel")
        for key, value in channel.items():
            node.append_child_value(key, value)
    return info
