"""When leases would have been given, how often and how rightly: from reactive to reliable."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from igrip.commitment import CommitmentConfig, Committer, Evidence
from igrip.lab.evaluation.recorded_trial import Bounds

if TYPE_CHECKING:
    import pandas as pd


def reliabilities(configured: float) -> tuple[float, ...]:
    """Return the reliabilities at which commitments are evaluated; the configured is among them."""
    return tuple(sorted({*(round(0.1 * k, 1) for k in range(11)), configured}))


RELIABILITIES = reliabilities(CommitmentConfig().reliability)
"""Those of the default configuration."""


class MessageEvidence(NamedTuple):
    """What commitment was decided on after one message."""

    hands: dict[str, Evidence]  # of each hand that was measured and accepted
    rejected: frozenset[str]  # hands whose measurement was rejected


class Lease(NamedTuple):
    """The beginning of a lease: when [s], for which hand, on which target."""

    t: float
    hand: str
    target: str


def find_leases(messages: Iterable[MessageEvidence], config: CommitmentConfig) -> list[Lease]:
    """Return the leases that begin in a recording, as if nobody had to confirm them."""
    return list(iterate_leases(messages, config))


def iterate_leases(
    messages: Iterable[MessageEvidence], config: CommitmentConfig
) -> Iterator[Lease]:
    """Yield them as they begin: who wants the first alone need not wait for the others."""
    config = config.model_copy(update={"needs_confirmation": False})
    committers: dict[str, Committer] = {}
    newest: dict[str, tuple[str, float]] = {}
    for message in messages:
        for hand in message.rejected & committers.keys():
            committers[hand].reject()
        for hand, evidence in message.hands.items():
            if hand not in committers:
                committers[hand] = Committer(config)
            lease = committers[hand].update(evidence)
            if lease is None:
                continue
            if newest.get(hand) != (lease.target, lease.since):
                yield Lease(evidence.t, hand, lease.target)
            newest[hand] = lease.target, lease.since


def first_commitments(
    messages: Iterable[MessageEvidence],
    config: CommitmentConfig,
    hand: str | None,
    target: str | None,
    bounds: Bounds | None,
) -> dict[str, Any]:
    """Return, for each reliability, when and how rightly a trial's hand was first committed for.

    ``reliability`` is the configured one. Of a reach: ``commit_part``, the part of the movement at
    the first lease (0 before the onset, None without one until the end), ``commit_right`` whether
    it was for the target. Of a recording without one: ``commits``, how many leases began.
    """
    messages = list(messages)
    curve = [
        find_leases(messages, config.model_copy(update={"reliability": reliability}))
        for reliability in reliabilities(config.reliability)
    ]
    configured = {"reliability": config.reliability}
    if bounds is None:
        return configured | {"commits": [len(leases) for leases in curve]}
    onset, end = bounds
    firsts = [next((s for s in leases if s.hand == hand and s.t <= end), None) for leases in curve]
    return configured | {
        "commit_part": [
            None if first is None else max(0.0, (first.t - onset) / (end - onset))
            for first in firsts
        ],
        "commit_right": [first is not None and first.target == target for first in firsts],
    }


def configured_reliability(rows: pd.DataFrame) -> float:
    """Return the reliability that the trials of one estimator were evaluated with."""
    known = rows["reliability"].dropna().tolist() if "reliability" in rows else []
    return float(known[0]) if known else CommitmentConfig().reliability


def at(reliability: float, curve: Iterable[dict[str, Any]]) -> dict[str, Any] | None:
    """Return the entry of :func:`summarise_commitments` at a reliability, if any."""
    return next((entry for entry in curve if entry["reliability"] == reliability), None)


def summarise_commitments(
    reaches: pd.DataFrame, none: pd.DataFrame, configured: float = CommitmentConfig().reliability
) -> list[dict[str, Any]]:
    """Return one entry for each reliability.

    ``committed`` is the share of reaches with a lease before their end, ``right`` the share of
    those that were first committed to the target, ``mean_part`` the mean part of the movement at
    the first lease, where a reach without one counts as 1; ``false_per_minute`` the leases that
    began in a minute without a reach.
    """
    known = reaches[reaches["commit_part"].notna()] if "commit_part" in reaches else reaches[:0]
    part = np.array([list(row) for row in known.get("commit_part", ())], dtype=np.float64)
    right = np.array([list(row) for row in known.get("commit_right", ())], dtype=bool)
    minutes = float(none["seconds"].sum()) / 60.0
    if not len(part) and not minutes:
        return []
    curve = []
    for k, reliability in enumerate(reliabilities(configured)):
        entry: dict[str, Any] = {"reliability": reliability}
        if len(part):
            given = ~np.isnan(part[:, k])  # where None was
            entry |= {
                "reaches": len(part), "committed": float(given.mean()),
                "right": float(right[given, k].mean()) if given.any() else None,
                "mean_part": float(np.where(given, part[:, k], 1.0).mean()),
            }  # fmt: skip
        if minutes:
            entry["false_per_minute"] = sum(row[k] for row in none["commits"].dropna()) / minutes
        curve.append(entry)
    return curve
