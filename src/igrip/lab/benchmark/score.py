"""Scores of one entry in one recording, from its intentions alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from igrip.intention import Commitment, Intention
from igrip.lab.benchmark.answers import Answers
from igrip.lab.evaluation.recorded_trial import Bounds, RecordedTrial
from igrip.lab.evaluation.trial_description import NO_REACH, find_problem
from igrip.lab.evaluation.trial_metrics import score_answers

Row = dict[str, Any]


def score_recording(recorded: RecordedTrial, answers: Answers) -> Row:
    """Return the scores of one entry in one recording.

    A lease is right if its target is that of the trial; where nobody reaches, every lease is false.

    Parameters
    ----------
    recorded : RecordedTrial
        The trial, and what was detected.
    answers : Answers
        Of the entry.

    Returns
    -------
    mapping
        ``problem`` where it cannot be scored; otherwise the columns of
        :func:`igrip.lab.evaluation.trial_metrics.score_answers`, those of the first lease, and
        the time that a message took.
    """
    trial = recorded.trial
    bounds = recorded.bounds() if trial.target != NO_REACH else None
    row: Row = {
        "recording": trial.recording, "participant": trial.participant or "unknown",
        "target": trial.target, "reach": trial.target != NO_REACH,
        "problem": find_problem(recorded, bounds), "seconds": recorded.seconds,
    }  # fmt: skip
    if row["problem"] is not None:
        return row
    row["ms"] = 1e3 * answers.seconds / max(1, len(recorded.times))
    row |= score_answers(trial, bounds, answers.intentions, recorded.times[-1])
    return row | _leases(answers.intentions, trial.hand, trial.target, bounds)


def _leases(
    intentions: Sequence[Intention], hand: str | None, target: str | None, bounds: Bounds | None
) -> Row:
    """Return whether the first lease during a reach was right and when, or how many were false."""
    if bounds is None:
        return {"false_leases": _count_leases(intentions)}
    onset, end = bounds
    own = (one for one in intentions if one.hand == hand and one.t <= end)
    first = next((one for one in own if one.commitment is not None), None)
    if first is None or first.commitment is None:
        return {"committed": False, "lease_right": None, "lease_part": None}
    return {
        "committed": True, "lease_right": first.commitment.target == target,
        "lease_part": max(0.0, (first.t - onset) / (end - onset)),
    }  # fmt: skip


def _count_leases(intentions: Sequence[Intention]) -> int:
    """Return how many leases began: where a hand has one for the first time, anew, or for another.

    What an entry says about when a lease began (``since``) does not count; that it has ended does.
    """
    count = 0
    held: dict[str, Commitment | None] = {}
    for one in intentions:
        before, now = held.get(one.hand), one.commitment
        if now is not None and (
            before is None or before.target != now.target or before.valid_until < one.t
        ):
            count += 1
        held[one.hand] = now
    return count
