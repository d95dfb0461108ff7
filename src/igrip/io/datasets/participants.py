"""The people of a dataset, from its ``participants.tsv``."""

from __future__ import annotations

import csv

from igrip.io.datasets.dataset import Dataset


def participants_without_trials(dataset: Dataset) -> list[str]:
    """Return the participants that have a row in their table, but no trial."""
    path = dataset.path / "participants.tsv"
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            named = [row.get("participant") for row in csv.DictReader(file, delimiter="\t")]
    except (OSError, UnicodeDecodeError, csv.Error):
        return []  # the table is optional
    present = {trial.participant for trial in dataset.trials}
    if present <= {None}:
        return []  # the trials have no column of participants
    return sorted({name for name in named if name and name not in present})
