"""How a number that a user may change is declared: default, unit, meaning and source together."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Settings(BaseModel):
    """Base of every module's configuration: frozen, and a misspelt name is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def quantity(default: Any, unit: str, meaning: str, source: str = "", **bounds: Any) -> Any:
    """Declare a number of a :class:`Settings` class.

    Parameters
    ----------
    default
        The value used when the user says nothing.
    unit
        Its unit, ``"1"`` for a pure number.
    meaning
        What it does, in one sentence.
    source
        Where the default comes from: a paper, a measurement or ``"guess"``.
    **bounds
        ``gt``, ``ge``, ``lt``, ``le`` as pydantic knows them.
    """
    return Field(
        default,
        description=f"{meaning} [{unit}]",
        json_schema_extra={"unit": unit, "source": source},
        **bounds,
    )
