"""Which confidence keeps the share of wrong commitments below what a user accepts.

The table was made by learn-then-test (Angelopoulos, Bates, Candès, Jordan & Lei 2021,
arXiv 2110.01052) on sources that the estimator had not learned from, one left out at a time
(``training/risk.py``). For each threshold it was tested that at most ``max_wrong`` of the first
commitments in reaches like those of each of these sources are wrong; the probability of a mistaken
test is 10 % for each source. Strange movements are tested apart: they need a higher threshold.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.errors import IgripError
from igrip.learned_weights import numbers, read_learned

Array = NDArray[np.float64]
FORMAT = "igrip-risk/1"
FILE = Path(__file__).with_name("risk.json")
FULL_FAMILIARITY = 0.3
"""From this familiarity on a movement counts as familiar; the strange ones of the table have half
of it or less."""


class RiskTable(NamedTuple):
    """Thresholds by the accepted share of wrong commitments.

    Attributes
    ----------
    max_wrong : (k,)
        Accepted shares, increasing.
    familiar, strange : (k,)
        Confidence from which to commit in familiar and in strange movements.
    """

    max_wrong: Array
    familiar: Array
    strange: Array

    def threshold(self, max_wrong: float, familiarity: float) -> float:
        """Return the confidence from which to commit.

        Parameters
        ----------
        max_wrong : float
            Accepted share of wrong commitments; below the lowest of the table that one is used.
        familiarity : float
            Of the movement, from 0 to 1.
        """
        familiar, strange = (
            float(np.interp(np.log(max_wrong), np.log(self.max_wrong), column))
            for column in (self.familiar, self.strange)
        )
        strangeness = 1.0 - min(1.0, familiarity / FULL_FAMILIARITY)
        return familiar + strangeness * (strange - familiar)


@cache
def default_risk() -> RiskTable:
    """Return the table that ships."""
    return read_risk(FILE)


def read_risk(path: Path) -> RiskTable:
    """Read a table.

    Raises
    ------
    IgripError
        If the file is not of this format, or its shares do not increase.
    """
    content = read_learned(path, FORMAT)
    max_wrong = numbers(content, ["max_wrong"], (-1,), path)
    table = RiskTable(
        max_wrong,
        *(numbers(content, [key], max_wrong.shape, path) for key in RiskTable._fields[1:]),
    )
    if not (np.diff(max_wrong, prepend=0.0) > 0.0).all():
        raise IgripError(f"{path}: max_wrong must be positive and increase")
    return table
