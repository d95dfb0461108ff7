"""A dataset replayed: the scores of all its trials, summed up as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.averages import average_scores
from igrip.lab.evaluation.predicted_times import summarise_times
from igrip.lab.evaluation.runner import TrialRun
from igrip.lab.evaluation.trial_rows import Row, score_run

FRACTIONS = ("40%", "60%")


class ReplayedTrial(NamedTuple):
    """One trial replayed."""

    rows: list[Row]  # one per estimator, of :func:`score_run`
    intentions: list[list[Intention]]  # of each estimator, if asked for
    cut: str | None  # where the recording was cut off


def replay_run(run: TrialRun, keep_intentions: bool = False) -> ReplayedTrial:
    """Return scores and, if wanted, intentions. A trial without a task is no problem here."""
    rows = score_run(run, commitments=False)
    if run.problem is None and (run.trial.target is None or run.trial.performed == "no"):
        rows = [row | {"problem": None} for row in rows]
    kept = [list(e.intentions) if keep_intentions else [] for e in run.estimators]
    return ReplayedTrial(rows, kept, run.cut)


def summarise_replay(dataset: Dataset, trials: Sequence[ReplayedTrial]) -> dict[str, Any]:
    """Return success and accuracy of each estimator over all trials, and over each group."""
    rows = [row for trial in trials for row in trial.rows]
    groups = sorted({row["group"] for row in rows if row.get("group")})
    results = []
    for name in dict.fromkeys(row["targets"] for row in rows):
        own = [row for row in rows if row["targets"] == name]
        for group in ("all", *groups):
            part = own if group == "all" else [row for row in own if row.get("group") == group]
            results.append({"targets": name, "group": group, **_averages(part)})
    first = [trial.rows[0] for trial in trials]
    return {
        "dataset": dataset.name,
        "derived": dataset.description.get("derived"),
        "trials": len({row["recording"] for row in first}),
        "participants": len({row["participant"] for row in first} - {None}),
        "results": results,
        "problems": [
            {key: row.get(key) for key in ("recording", "trial", "targets", "problem")}
            for row in rows if row["problem"] is not None
        ],
        "remarks": [
            {"recording": row["recording"], "remark": row["remark"]}
            for row in first if row.get("remark")
        ],
        "cut": sorted({trial.cut for trial in trials if trial.cut}),
    }  # fmt: skip


def _averages(rows: Sequence[Row]) -> dict[str, Any]:
    reaches = [row for row in rows if "success" in row]
    if not reaches:
        return {"trials": 0}
    columns = {key: [row[key] for row in reaches] for key in reaches[0]}
    averages = average_scores(columns)
    accuracy = averages.pop("accuracy")
    result = {"trials": len(reaches), "success": averages["success"]}
    result |= {f"accuracy_{part}": accuracy[part] for part in FRACTIONS} | averages
    return result | {"times": summarise_times(columns)}
