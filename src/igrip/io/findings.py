"""Samples that are checked for plausibility, and what is found."""

from __future__ import annotations

from collections.abc import Iterable
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
