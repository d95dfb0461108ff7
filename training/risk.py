"""The thresholds of commitments, by learn-then-test on sources that were not learned from.

For each source, the scorer is learned from all others, and the first commitment of each of its
reaches is found at every threshold. A threshold stands if the hypothesis that more than
``max_wrong`` of the first commitments are wrong can be rejected (binomial tail, at ``DELTA``) for
it and for every higher one with enough commitments, on every source: fixed-sequence testing keeps
the error of the whole search at ``DELTA`` for each source.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from igrip.commitment import CommitmentConfig, Committer
from igrip.risk import FORMAT, FULL_FAMILIARITY, RiskTable
from training.moments import Recording
from training.strangers import Answered

Array = NDArray[np.float64]
MAX_WRONG = (0.01, 0.02, 0.05, 0.1, 0.2)
THRESHOLDS = np.round(np.arange(0.5, 0.991, 0.01), 2)
DELTA = 0.1
STRANGE = 0.5 * FULL_FAMILIARITY  # movements below it are calibrated apart
DWELL = CommitmentConfig().dwell


class Commitments(NamedTuple):
    """The first commitment of each reach at each threshold; rows are reaches.

    Attributes
    ----------
    wrong : (n, t)
        1 wrong, 0 right, NaN none before the end of the movement.
    familiarity : (n, t)
        Of the movement then.
    part : (n, t)
        Of the movement that was over then.
    """

    wrong: Array
    familiarity: Array
    part: Array


def first_commitments(answered: Iterable[Answered]) -> Commitments:
    """Return the first commitment of each reach at each of :data:`THRESHOLDS`."""
    rows = []
    for recording, _, evidence in answered:
        row = np.full((3, len(THRESHOLDS)), np.nan)
        for k, threshold in enumerate(THRESHOLDS):
            fixed = CommitmentConfig(
                reliability=0.5, min_threshold=threshold, max_threshold=threshold,
                max_dwell=2.0 * DWELL, strange_margin=0.0,
            )  # fmt: skip
            committer = Committer(fixed)
            for one in evidence:
                if one.t > recording.end:
                    break
                if committer.update(one) is not None:
                    assert one.familiarity is not None
                    part = (one.t - recording.onset) / (recording.end - recording.onset)
                    wrong = committer.target != recording.target
                    row[:, k] = wrong, one.familiarity, max(0.0, part)
                    break
        rows.append(row)
    return Commitments(*np.array(rows).reshape(-1, 3, len(THRESHOLDS)).swapaxes(0, 1))


def thresholds(sources: Sequence[Commitments], strange: bool) -> Array:
    """Return the threshold for each of :data:`MAX_WRONG`, for strange or familiar movements.

    The sequence of tests begins at the highest threshold at which a source has enough commitments
    to show anything. A source that never has enough asks for the highest threshold.
    """
    return np.array([max(_threshold(s, strange, m) for s in sources) for m in MAX_WRONG])


def _threshold(source: Commitments, strange: bool, max_wrong: float) -> float:
    """Return the lowest threshold that stands on one source."""
    lowest = float(THRESHOLDS[-1])
    for k in range(len(THRESHOLDS) - 1, -1, -1):
        chosen = ~np.isnan(source.wrong[:, k])
        chosen &= (source.familiarity[:, k] < STRANGE) == strange
        count, wrong = int(chosen.sum()), int(np.nansum(source.wrong[chosen, k]))
        if binom.cdf(0, count, max_wrong) > DELTA:
            continue  # too few to show anything
        if binom.cdf(wrong, count, max_wrong) > DELTA:
            break
        lowest = float(THRESHOLDS[k])
    return lowest


def fit_risk(sources: Sequence[Commitments]) -> RiskTable:
    """Return the table that holds for every source."""
    return RiskTable(
        np.array(MAX_WRONG), thresholds(sources, strange=False), thresholds(sources, strange=True)
    )


def write_risk(table: RiskTable, provenance: dict[str, Any], path: Path) -> None:
    """Write the table as text."""
    content = {"format": FORMAT, "provenance": provenance}
    rows = {name: column.tolist() for name, column in table._asdict().items()}
    path.write_text(json.dumps(content | rows, indent=1) + "\n", encoding="utf-8")


def is_reach(recording: Recording) -> bool:
    """Return whether a recording holds a reach for an object that is seen."""
    return recording.target is not None and not recording.absent and math.isfinite(recording.end)
