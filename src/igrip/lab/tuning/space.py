"""Which numbers are tuned to a person, between which bounds, and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from igrip.config import Config

Values = Mapping[str, float]
"""Numbers of a configuration, by key."""
COMMITMENT = "commitment."


class Parameter(NamedTuple):
    """A number that is tuned.

    Attributes
    ----------
    key : str
        Of the configuration, as in ``docs/configuration.md``.
    low, high, step : float
        Its values, in the unit of the key.
    source : str
        Why these.
    """

    key: str
    low: float
    high: float
    step: float
    source: str


SPACE: tuple[Parameter, ...] = (
    Parameter(
        "commitment.reliability", 0.0, 1.0, 0.01,
        "the one knob of docs/commitment.md, over its whole range",
    ),
    Parameter(
        "commitment.max_dwell", 0.0, 0.5, 0.01,
        "guess: a slow arm has more time to wait than a quick one",
    ),
    Parameter(
        "commitment.strange_margin", 0.0, 0.3, 0.01,
        "0: one's own way of moving is not strange; 0.3: twice the default",
    ),
    Parameter(
        "motion.reach.time_constant", 0.04, 0.1, 0.02,
        "guess: a longer memory for slow movements; 0.04-0.15 were tried on quick ones",
    ),
)  # fmt: skip
RELIABILITIES = (0.0, 0.2, 0.4, 0.5, 0.55, 0.65, 0.7, 0.8, 0.9, 1.0)
"""Tried first, with everything else as it is: what a person could set by hand."""


def is_upstream(key: str) -> bool:
    """Return whether a number acts before the commitment: the trials must be replayed anew."""
    return not key.startswith(COMMITMENT)


def values_of(config: Config, space: Sequence[Parameter] = SPACE) -> dict[str, float]:
    """Return the numbers that a configuration has at present."""
    values = {}
    for parameter in space:
        value: Any = config
        for name in parameter.key.split("."):
            value = getattr(value, name)
        values[parameter.key] = float(value)
    return values


def with_values(config: Config, values: Values) -> Config:
    """Return the configuration with other numbers.

    Raises
    ------
    pydantic.ValidationError
        If a key is unknown or a value out of bounds.
    """
    content = config.model_dump()
    for key, value in values.items():
        *path, name = key.split(".")
        table = content
        for part in path:
            table = table[part]
        table[name] = value
    return Config(**content)


def first_candidates(config: Config, space: Sequence[Parameter] = SPACE) -> list[dict[str, float]]:
    """Return what every search begins with: the present numbers, then other reliabilities."""
    present = values_of(config, space)
    key = "commitment.reliability"
    return [present, *(present | {key: r} for r in RELIABILITIES if r != present[key])]
