"""Leases judged: how early, how often and how rightly, from reactive to reliable."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

from igrip.commitment import CommitmentConfig, Committer, Evidence

if TYPE_CHECKING:
    import pandas as pd

POINTS = tuple(sorted({*(round(0.1 * k, 1) for k in range(11)), CommitmentConfig().reliability}))
"""Reliabilities at which commitments are judged; the default is among them."""


class Curve:
    """The leases that one estimator would have given in one recording, at every reliability.

    The estimator runs once; what it says is shown to a committer for each reliability and hand.
    """

    def __init__(self, config: CommitmentConfig) -> None:
        plain = config.model_copy(update={"needs_confirmation": False})  # nobody is there to do so
        self._configs = [plain.model_copy(update={"reliability": r}) for r in POINTS]
        self._committers: dict[str, list[Committer]] = {}
        self._leases: dict[str, list[tuple[str, float] | None]] = {}
        self.begun: list[list[tuple[float, str, str]]] = [[] for _ in POINTS]

    def take(self, evidence: Mapping[str, Evidence], doubted: Collection[str] = ()) -> None:
        """Take what is known of each hand after a message, and which could not be believed."""
        for hand in doubted:
            for committer in self._committers.get(hand, ()):
                committer.reject()
        for hand, seen in evidence.items():
            if hand not in self._committers:
                self._committers[hand] = [Committer(config) for config in self._configs]
                self._leases[hand] = [None] * len(POINTS)
            before = self._leases[hand]
            for k, committer in enumerate(self._committers[hand]):
                lease = committer.update(seen)
                if lease is None:
                    continue
                if before[k] != (lease.target, lease.since):
                    self.begun[k].append((seen.t, hand, lease.target))
                before[k] = (lease.target, lease.since)


def judge_commitments(
    curve: Curve, hand: str | None, target: str | None, bounds: tuple[float, float] | None
) -> dict[str, Any]:
    """Return, for each reliability, when and how rightly a trial's hand was first committed for.

    Of a reach: ``commit_part``, the part of the movement at the first lease (0 before the onset,
    None without one until the end), ``commit_right`` whether it was for the target. Of a recording
    without one: ``commits``, how many leases began.
    """
    if bounds is None:
        return {"commits": [len(begun) for begun in curve.begun]}
    onset, end = bounds
    parts: list[float | None] = []
    right = []
    for begun in curve.begun:
        first = next(((t, id) for t, by, id in begun if by == hand and t <= end), None)
        parts.append(None if first is None else max(0.0, (first[0] - onset) / (end - onset)))
        right.append(first is not None and first[1] == target)
    return {"commit_part": parts, "commit_right": right}


def sum_up(reaches: pd.DataFrame, none: pd.DataFrame) -> list[dict[str, Any]]:
    """Return one entry for each reliability.

    ``committed`` is the share of reaches with a lease before their end, ``right`` the share of
    those that were first committed to the target, ``mean_part`` the mean part of the movement at
    the first lease, where a reach without one counts as 1; ``false_per_minute`` the leases that
    began in a minute without a reach.
    """
    import numpy as np

    has = "commit_part" in reaches and bool(reaches["commit_part"].notna().any())
    known = reaches[reaches["commit_part"].notna()] if has else reaches[:0]
    minutes = float(none["seconds"].sum()) / 60.0 if len(none) else 0.0
    if not len(known) and not minutes:
        return []
    rows = list(known["commit_part"]) if has else []
    part = np.array([[np.nan if x is None else float(x) for x in row] for row in rows])
    right = np.array([list(map(bool, row)) for row in known["commit_right"]] if has else [])
    told = []
    for k, reliability in enumerate(POINTS):
        entry: dict[str, Any] = {"reliability": reliability}
        if len(part):
            given = ~np.isnan(part[:, k])
            entry |= {
                "reaches": len(part), "committed": float(given.mean()),
                "right": float(right[given, k].mean()) if given.any() else None,
                "mean_part": float(np.where(given, part[:, k], 1.0).mean()),
            }  # fmt: skip
        if minutes and "commits" in none:
            entry["false_per_minute"] = sum(row[k] for row in none["commits"].dropna()) / minutes
        told.append(entry)
    return told
