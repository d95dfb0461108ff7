"""Markers of a study on the Lab Streaming Layer, for the laboratory's other recorders."""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping
from typing import Any

from igrip.errors import requires_extra
from igrip.version import __version__

log = logging.getLogger(__name__)
SENT = {
    "session_started", "trial_started", "trial_recorded", "trial_interrupted", "trial_marked",
    "commented", "break_ended", "session_ended",
}  # fmt: skip


class LslMarkers:
    """One outlet of the type Markers: each event of the journal as JSON, when it happens.

    Parameters
    ----------
    name : str
        Of the stream.
    study, participant : str
        Parts of its source id, so that a recorder finds it again after a restart.

    Raises
    ------
    MissingExtraError
        If pylsl is not installed.
    """

    def __init__(self, name: str, study: str, participant: str) -> None:
        # pylsl raises RuntimeError where liblsl is missing
        with requires_extra("pylsl", "outputs", "Lab Streaming Layer", (ImportError, RuntimeError)):
            import pylsl
        source = f"igrip-study-{study}-{participant}"
        info = pylsl.StreamInfo(name, "Markers", 1, pylsl.IRREGULAR_RATE, "string", source)
        described = info.desc()
        described.append_child("acquisition").append_child_value(
            "software_version", f"igrip {__version__}"
        )
        channel = described.append_child("channels").append_child("channel")
        channel.append_child_value("label", "study").append_child_value("type", "Marker")
        self._participant = participant
        self._outlet = pylsl.StreamOutlet(info)

    def send(self, event: Mapping[str, Any]) -> None:
        """Push an event of the journal."""
        if event["event"] in SENT:
            marker = {key: value for key, value in event.items() if key != "at"}
            marker["participant"] = self._participant
            try:
                self._outlet.push_sample([json.dumps(marker, ensure_ascii=False)])
            except Exception as error:  # a marker that is lost must not cost a trial
                log.warning("LSL: %s was not sent: %s", event["event"], error)

    def close(self) -> None:
        """Close the outlet."""
        self._outlet = None
