"""Replayed trials beside what the evaluation says of the same ones."""

import pytest

from igrip import load_objects
from igrip.commitment import CommitmentConfig
from igrip.config import Config
from igrip.errors import DatasetError
from igrip.lab.evaluation.commitments import RELIABILITIES
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.trial_rows import score_run
from igrip.lab.tuning.replays import Replays, choose_trials, people_of

DEFAULT = RELIABILITIES.index(CommitmentConfig().reliability)


def test_outcomes_are_those_of_an_evaluation(small_dataset):
    catalog = load_objects(*small_dataset.objects)
    replays = Replays(small_dataset, catalog, Config(), small_dataset.trials)
    for values in ({}, {"motion.reach.time_constant": 0.1}):
        config = Config(motion={"reach": {"time_constant": 0.1}}) if values else Config()
        outcomes = replays.outcomes(values)
        for k, trial in enumerate(small_dataset.trials):
            [row] = score_run(run_trial(small_dataset, trial, catalog, [config]))
            part = row["commit_part"][DEFAULT]
            assert outcomes.committed[k] == (part is not None)
            if part is not None:
                assert outcomes.part[k] == part
                assert outcomes.right[k] == row["commit_right"][DEFAULT]
                assert 0.0 < outcomes.stated[k] < 1.0


def test_a_trial_that_cannot_be_read_is_named(small_dataset):
    small_dataset.recording(small_dataset.trials[0]).unlink()
    catalog = load_objects(*small_dataset.objects)
    replays = Replays(small_dataset, catalog, Config(), small_dataset.trials)
    assert [one.recording for one in replays.usable] == ["reach1"]
    assert [one.recording for one in replays.unusable] == ["reach0"]
    assert "no recording" in replays.unusable[0].problem


def test_trials_of_a_person(small_dataset):
    assert people_of(small_dataset) == ["p1"]
    assert choose_trials(small_dataset, ["p1", "p1"], 0) == list(small_dataset.trials)
    assert len(choose_trials(small_dataset, ["p1"], 1)) == 1
    with pytest.raises(DatasetError, match="no participant 'p2'; there are: p1"):
        choose_trials(small_dataset, ["p2"], 0)
