"""Intentions as a tidy table: a row for each intention and candidate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, Literal

from igrip.cues import CUES
from igrip.intention import Intention

Per = Literal["candidate", "intention"]

ORIGIN = {"recording": str, "targets": str}
INTENTION = {
    "t": float, "hand": str, "status": str, "reason": str, "target": str, "target_model": str,
    "confidence": float, "grip": str, "grip_probability": float,
    "time_to_contact": float, "time_to_contact_low": float, "time_to_contact_high": float,
    "time_to_end": float, "time_to_end_low": float, "time_to_end_high": float,
    "contact_x": float, "contact_y": float, "contact_z": float, "familiarity": float,
    "commitment_target": str, "commitment_grip": str, "commitment_since": float,
    "commitment_valid_until": float,
}  # fmt: skip
CANDIDATE = {"candidate": str, "probability": float}
GLOBAL = "global"


@cache
def columns(per: Per = "candidate") -> dict[str, type]:
    """Return the names of the columns, in order, and whether each holds text or numbers."""
    if per == "intention":
        return {**ORIGIN, **INTENTION}
    scores: dict[str, type] = {f"score_{name}": float for name in (GLOBAL, *CUES.names())}
    return {**ORIGIN, **INTENTION, **CANDIDATE, **scores}


def rows_of(
    intention: Intention, origin: Mapping[str, Any], per: Per = "candidate"
) -> Iterator[dict[str, Any]]:
    """Yield the rows of one intention; what is unknown is left out.

    Parameters
    ----------
    intention : Intention
        The message.
    origin : mapping
        ``recording`` and ``targets``, as far as they are known.
    per : str
        ``candidate``: a row for each object and for ``none``, and one without a candidate where
        there are none; ``intention``: one row.
    """
    common = {name: origin[name] for name in ORIGIN if name in origin} | _common(intention)
    probability = intention.probability or {}
    candidates = list(dict.fromkeys((*probability, *intention.scores)))
    if per == "intention" or not candidates:
        yield common
        return
    for candidate in candidates:
        scores = intention.scores.get(candidate, {})
        row = common | {f"score_{name}": value for name, value in scores.items()}
        row["candidate"] = candidate
        if candidate in probability:
            row["probability"] = probability[candidate]
        yield row


def _common(intention: Intention) -> dict[str, Any]:
    row = {name: value for name in INTENTION if (value := getattr(intention, name, None))
           is not None}  # fmt: skip
    row.pop("grip_probability", None)
    if intention.grip is not None and intention.grip_probability is not None:
        row["grip_probability"] = intention.grip_probability.get(intention.grip)
    for time in ("time_to_contact", "time_to_end"):
        interval = getattr(intention, f"{time}_interval")
        if interval is not None:
            row[f"{time}_low"], row[f"{time}_high"] = interval
    if intention.contact is not None:
        row |= dict(zip(("contact_x", "contact_y", "contact_z"), intention.contact, strict=True))
    lease = intention.commitment
    if lease is not None:
        for name in ("target", "grip", "since", "valid_until"):
            row[f"commitment_{name}"] = getattr(lease, name)
    return row
