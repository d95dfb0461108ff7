"""What a reviewer corrected: later decisions replace earlier ones, and none is ever overwritten."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

Bounds = tuple[float, float]
"""Onset and end of a movement [s]."""


class Corrections:
    """The sum of the events of a review.

    Parameters
    ----------
    events : iterable of mapping
        Of the file ``review.jsonl``, in order.
    """

    def __init__(self, events: Iterable[Mapping[str, Any]] = ()) -> None:
        self._bounds: dict[str, Bounds | None] = {}
        self._performed: dict[tuple[int, int], bool] = {}
        for event in events:
            self.add(event)

    def add(self, event: Mapping[str, Any]) -> None:
        """Take one more event into account."""
        name = event["event"]
        if name == "bounds_corrected":
            bounds = (float(event["onset_s"]), float(event["end_s"]))
            self._bounds[str(event["recording"])] = bounds
        elif name == "bounds_withdrawn":
            self._bounds[str(event["recording"])] = None
        elif name == "judged":
            self._performed[int(event["trial"]), int(event["attempt"])] = bool(event["performed"])

    def bounds(self, recording: str) -> Bounds | None:
        """Return the corrected onset and end [s]; None: those of the trace hold."""
        return self._bounds.get(recording)

    def performed(self, trial: int, attempt: int) -> bool | None:
        """Return whether the participant did as told; None: what the experimenter said holds."""
        return self._performed.get((trial, attempt))
