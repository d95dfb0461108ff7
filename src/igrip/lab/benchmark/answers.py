"""Answers of an entry: intentions that can be scored, or what is wrong with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from igrip.errors import IgripError, did_you_mean
from igrip.intention import Intention
from igrip.observation import Observation

SUM_TOLERANCE = 1e-3  # of probabilities


class EntryError(IgripError, ValueError):
    """An entry of the benchmark cannot be run, or answers with something else than intentions."""


@dataclass(frozen=True)
class Answers:
    """What an entry answered to one recording.

    Attributes
    ----------
    intentions : list of Intention
        In order.
    seconds : float
        Time that it took [s]; of a program with its start.
    """

    intentions: list[Intention]
    seconds: float


def intention_of(found: Intention | Mapping[str, Any] | bytes) -> Intention:
    """Return an answer as an intention.

    Raises
    ------
    EntryError
        If it is none.
    """
    if isinstance(found, Intention):
        return found
    try:
        fields = msgspec.json.decode(found) if isinstance(found, bytes) else _plain(found)
        unknown = sorted(set(fields) - set(Intention.__struct_fields__) - {"schema"})
        if unknown:
            near = did_you_mean(unknown[0], Intention.__struct_fields__)
            raise EntryError(f"answered with {unknown[0]!r:.60}, which no intention has{near}")
        return msgspec.convert(fields, Intention)
    except (msgspec.MsgspecError, TypeError) as error:
        raise EntryError(f"answered what is no intention: {found!r:.100}: {error}") from None


def _plain(value: Any) -> Any:
    """Return a value with Python's own numbers in place of numpy's."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def checked(found: list[Intention], observations: Sequence[Observation]) -> list[Intention]:
    """Return intentions that can be scored.

    Raises
    ------
    EntryError
        If there are none, or their probabilities are none.
    """
    if not found and any(observation.hands for observation in observations):
        raise EntryError("answered nothing to a recording with hands")
    for one in found:
        if one.probability is None:
            continue
        values = one.probability.values()
        if not all(0.0 <= value <= 1.0 for value in values):
            raise EntryError(f"gave probabilities that are not from 0 to 1: {one.probability}")
        if abs(sum(values) - 1.0) > SUM_TOLERANCE:
            raise EntryError(
                f"gave probabilities with the sum {sum(values):.4g}, not 1 (with 'none'): "
                f"{one.probability}"
            )
    return found
