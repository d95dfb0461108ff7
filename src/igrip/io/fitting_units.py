"""Which unit numbers would fit that cannot be meant as they are taken."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence


def fitting_units(
    value: float, unit: str, units: Mapping[str, float], bounds: tuple[float, float], usual: float
) -> list[str]:
    """Return the units in which the source's numbers would fit, the likeliest first."""
    given = value / units[unit]
    fits = {name: given * size for name, size in units.items() if name != unit}
    fits = {name: x for name, x in fits.items() if bounds[0] <= x <= bounds[1]}
    common = {name: x for name, x in fits.items() if name not in ("dm", "in")} or fits
    return sorted(common, key=lambda name: abs(math.log(common[name] / usual)))


def fix_by(word: str, units: Sequence[str]) -> tuple[str, str] | None:
    """Return the declaration that would mend a finding; None where no unit fits."""
    return (word, units[0]) if units else None


def question(verb: str, units: Sequence[str]) -> str:
    """Return whether it is one of these units, as a question; empty without any."""
    named = ("inches" if unit == "in" else unit for unit in units)
    return f": {verb} {' or '.join(named)}?" if units else ""


def format_number(value: float) -> str:
    """Return a number of three digits as text."""
    return f"{value:.3g}" if not 1e3 <= value < 1e7 else f"{value:.0f}"
