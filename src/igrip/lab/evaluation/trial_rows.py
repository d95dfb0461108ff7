"""A trial as rows of a table, one per estimator: the one way from a run to its scores."""

from __future__ import annotations

from typing import Any

from igrip.lab.evaluation.commitments import first_commitments
from igrip.lab.evaluation.predicted_times import contact_time, score_times
from igrip.lab.evaluation.runner import EstimatorRun, TrialRun
from igrip.lab.evaluation.trial_description import (
    NO_REACH,
    describe_trial,
    find_problem,
    find_remarks,
)
from igrip.lab.evaluation.trial_metrics import score_answers

Row = dict[str, Any]


def score_run(run: TrialRun, commitments: bool = True) -> list[Row]:
    """Return a row per estimator, with ``problem`` where the trial cannot be scored.

    What leaves something to score (a recording that is cut off, an object without a model) is named
    as ``remark``.
    """
    trial = run.trial
    base: Row = {
        "recording": trial.recording, "participant": trial.participant, "target": trial.target,
        "hand": trial.hand,
    }  # fmt: skip
    try:
        return [base | row for row in _score(run, commitments)]
    except Exception as error:  # one odd recording must not end the evaluation of all others
        problem = f"cannot be evaluated: {error!r:.200}"
        return [base | {"targets": e.config.targets, "problem": problem} for e in run.estimators]


def _score(run: TrialRun, commitments: bool) -> list[Row]:
    trial, recorded = run.trial, run.recorded
    reaches = trial.target != NO_REACH and run.problem is None
    bounds = recorded.bounds() if reaches else None
    problem = run.problem or find_problem(recorded, bounds)
    row = describe_trial(recorded, bounds, run.objects) | {"problem": problem, "remark": None}
    if problem is not None:
        return [row | {"targets": e.config.targets} for e in run.estimators]
    remarks = run.unknown_objects + find_remarks(recorded, bounds) + ([run.cut] if run.cut else [])
    row["remark"] = "; ".join(remarks) or None

    contact = contact_time(recorded, bounds) if bounds and trial.target else None

    def score(estimator: EstimatorRun) -> Row:
        intentions, last = estimator.intentions, recorded.times[-1]
        scores = score_answers(trial, bounds, intentions, last)
        if bounds and trial.target:
            scores |= score_times(trial.hand, trial.target, bounds, contact, intentions, last)
        if commitments:
            scores |= first_commitments(
                estimator.evidence, estimator.config.commitment, trial.hand, trial.target, bounds
            )
        return row | {"targets": estimator.config.targets} | scores

    return [score(estimator) for estimator in run.estimators]
