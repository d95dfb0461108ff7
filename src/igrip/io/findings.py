"""Findings of the plausibility check, and the words in which they name what would fit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Finding(NamedTuple):
    """One thing that is implausible.

    Attributes
    ----------
    verdict : str
        ``refuse``: the numbers cannot be meant so; ``remark``: they can, but it is unusual.
    kind : str
        ``interval``, ``length``, ``extent``, ``speed``, ``size``, ``missing``, ``repeats``, ``up``.
    text : str
        For the user; it names the unit or frame that would fit.
    fix : 2 str, optional
        The argument of :meth:`igrip.io.frames.DeclaredFrame.declare` that would mend it, and its
        value.
    """

    verdict: Literal["refuse", "remark"]
    kind: str
    text: str
    fix: tuple[str, str] | None = None


@dataclass(frozen=True)
class Samples:
    """The measurements of one hand or object, as they are taken: metres, seconds, x, y, z, w.

    Parameters
    ----------
    times : (n,)
        [s].
    positions : (n, 3)
        [m]; a row with NaN: not seen.
    orientations : (n, 4), optional
        World from mesh; a row with NaN: not seen.
    """

    times: Array
    positions: Array
    orientations: Array | None = None


def options_that_fix(findings: Iterable[Finding]) -> str:
    """Return the options of a command line that would mend findings, such as ``--up y``."""
    fixes = dict(f.fix for f in findings if f.fix is not None).items()
    return " ".join(f"--{word.replace('_', '-')} {value}" for word, value in fixes)


def refusal(findings: Iterable[Finding]) -> str | None:
    """Return why data are refused, as one text; None if they are not."""
    return "; ".join(f.text for f in findings if f.verdict == "refuse") or None


def fitting_units(
    value: float, unit: str, units: Mapping[str, float], bounds: tuple[float, float], usual: float
) -> list[str]:
    """Return the units in which the source's numbers would fit, the likeliest first."""
    given = value / units[unit]
    fits = {name: given * size for name, size in units.items() if name != unit}
    fits = {name: x for name, x in fits.items() if bounds[0] <= x <= bounds[1]}
    common = {name: x for name, x in fits.items() if name not in ("dm", "in")} or fits
    return sorted(common, key=lambda name: abs(math.log(common[name] / usual)))


def fix_of(word: str, units: list[str]) -> tuple[str, str] | None:
    """Return the declaration that would mend a finding, by the likeliest unit."""
    return (word, units[0]) if units else None


def question(verb: str, units: list[str]) -> str:
    """Return the question whether it is one of the units, as text; empty without any."""
    return f": {verb} {' or '.join(units)}?" if units else ""


def number_text(value: float) -> str:
    """Return a number as text, with three digits, or whole where it is large."""
    return f"{value:.3g}" if not 1e3 <= value < 1e7 else f"{value:.0f}"
