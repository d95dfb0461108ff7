"""Estimators over the recordings of a small dataset, in one process and in two."""

import json
from dataclasses import replace

import numpy as np
import pytest

from igrip import Config, Estimator, load_objects
from igrip.io.datasets import dataset as dataset_module
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings import open_source
from igrip.lab.evaluation.runner import run_trial, run_trials, spread
from igrip.lab.parallel import Workers

CONFIGS = (Config(targets="distance"), Config(targets="paper"))


@pytest.fixture
def catalog(small_dataset):
    return load_objects(*small_dataset.objects)


def test_a_run_holds_what_each_estimator_answered(small_dataset, catalog):
    trial = small_dataset.trials[0]
    run = run_trial(small_dataset, trial, catalog, CONFIGS)
    assert run.trial is trial
    assert (run.problem, run.cut, run.unknown_objects) == (None, None, [])
    assert len(run.recorded.times) == 61
    assert [e.config for e in run.estimators] == list(CONFIGS)
    estimator = Estimator(catalog, CONFIGS[1])
    answers = run.estimators[1]
    for k, observation in enumerate(open_source(small_dataset.recording(trial))):
        [intention] = estimator.update(observation)
        assert answers.intentions[k] == intention
        motion = estimator.hands["right"].motion
        known = intention.status in ("idle", "reaching") and motion is not None
        np.testing.assert_equal(answers.speeds[k], motion.speed if known else np.nan)
        assert answers.evidence[k].rejected == estimator.rejected_hands
        for hand, evidence in estimator.evidence.items():
            kept = answers.evidence[k].hands[hand]
            trusted = frozenset(id for id in ("near", "far") if id in evidence.trusted_objects)
            assert kept == evidence._replace(trusted_objects=trusted)
    assert {i.status for i in answers.intentions} >= {"warming_up", "reaching"}
    assert run.estimators[0].intentions[-1].target == trial.target


def test_evidence_stays_as_it_was(small_dataset, catalog):
    """Which objects are trusted is written down at once: the near one is missed at the end."""
    trial = small_dataset.trials[0]
    path = small_dataset.recording(trial)
    path.write_text(path.read_text() + '{"t": 2.5, "objects": {"near": null}}\n')
    [answers] = run_trial(small_dataset, trial, catalog, CONFIGS[:1]).estimators
    assert answers.evidence[-1].hands == {}
    assert answers.evidence[-2].hands["right"].trusted_objects == {"near", "far"}


def test_a_hand_that_is_lost_has_no_speed(small_dataset, catalog):
    trial = small_dataset.trials[0]
    path = small_dataset.recording(trial)
    path.write_text(path.read_text() + '{"t": 2.5}\n')
    [answers] = run_trial(small_dataset, trial, catalog, CONFIGS[:1]).estimators
    assert [i.status for i in answers.intentions[-2:]] != ["lost", "lost"]
    assert answers.intentions[-1].status == "lost"
    assert answers.estimator.hands["right"].motion is not None
    assert np.isfinite(answers.speeds[-2])
    assert np.isnan(answers.speeds[-1])


def test_objects_are_those_at_the_onset(small_dataset, catalog):
    trial = small_dataset.trials[0]
    path = small_dataset.recording(trial)
    pose = {"position": [0, 0.9, 0], "orientation": [0, 0, 0, 1], "static": True}
    moved = json.dumps({"t": 2.5, "objects": {"near": pose}}) + "\n"
    path.write_text(path.read_text() + moved)

    def near(onset_s):
        run = run_trial(small_dataset, replace(trial, onset_s=onset_s), catalog, CONFIGS[:1])
        return {placed.id: placed.centre[1] for placed in run.objects}["near"]

    assert near(1.0) == pytest.approx(0.25)
    assert near(2.5) > 0.3
    assert near(None) == near(2.5)
    assert near(-1.0) == pytest.approx(0.25)  # the first that are known


def test_objects_without_a_model_are_named(small_dataset):
    catalog = load_objects("box:0.1x0.1x0.1")
    run = run_trial(small_dataset, small_dataset.trials[0], catalog, CONFIGS)
    assert run.problem is None
    assert [text.split(":")[0] for text in run.unknown_objects] == ["far", "near"]
    assert "the catalogue has no model" in run.unknown_objects[0]


def test_a_recording_that_is_cut_off(small_dataset, catalog):
    path = small_dataset.recording(small_dataset.trials[0])
    path.write_bytes(path.read_bytes()[:-9])
    run = run_trial(small_dataset, small_dataset.trials[0], catalog, CONFIGS)
    assert "cut off in line 61" in run.cut
    assert run.problem is None


def test_problems_of_a_recording(small_dataset, catalog):
    trial = small_dataset.trials[0]
    gone = run_trial(small_dataset, replace(trial, recording="gone"), catalog, CONFIGS)
    assert "no recording 'gone'" in gone.problem
    assert [e.intentions for e in gone.estimators] == [[], []]
    path = small_dataset.recording(trial)
    path.write_text('{"t": 0}\n{"t": -1}\n{"t": 0.1}\n')
    damaged = run_trial(small_dataset, trial, catalog, CONFIGS)
    assert damaged.problem is None
    assert "first in line 2 (t: is -1 s, before all times so far)" in damaged.cut
    assert damaged.recorded.times == [0.0, 0.1]
    path.write_text('{"t": "x"}\n{"t": null}\n')
    broken = run_trial(small_dataset, trial, catalog, CONFIGS)
    assert broken.problem.startswith(f"{path}, line 1: t: must be a number")
    assert broken.recorded.times == []
    row = run_trial(small_dataset, replace(trial, problem="line 3 is wrong"), catalog, CONFIGS)
    assert row.problem == "line 3 is wrong"
    assert row.recorded.times == []


def test_an_odd_recording_ends_only_itself(small_dataset, catalog, monkeypatch):
    def broken(path, frame):
        raise RuntimeError("of a kind that nobody foresaw")

    monkeypatch.setattr(dataset_module, "open_source", broken)
    run = run_trial(small_dataset, small_dataset.trials[0], catalog, CONFIGS)
    assert run.problem == "cannot be evaluated: RuntimeError('of a kind that nobody foresaw')"


def answered(run):
    """Return what is compared between processes."""
    return run.trial.recording, [(e.config.targets, e.intentions) for e in run.estimators]


def test_processes_change_nothing(small_dataset, catalog):
    trials = small_dataset.trials
    alone = list(run_trials(small_dataset, catalog, CONFIGS, answered, trials))
    together = list(run_trials(small_dataset, catalog, CONFIGS, answered, trials * 2, Workers(2)))
    assert alone * 2 == together
    assert [name for name, _ in alone] == [trial.recording for trial in trials]
    assert [name for name, _ in alone[0][1]] == ["distance", "paper"]


def test_trials_evenly_spread():
    assert spread("abcdefghij", 0) == spread("abcdefghij", 10) == list("abcdefghij")
    assert spread("abcdefghij", 99) == list("abcdefghij")
    assert spread("abcdefghij", 5) == list("acegi")
    assert spread("abcdefghij", 3) == list("adg")
    assert spread("abcdefghij", 1) == ["a"]
    assert spread("", 0) == spread("", 3) == []


def test_folders_of_meshes_travel_with_a_dataset(tmp_path):
    (tmp_path / "meshes").mkdir()
    dataset = Dataset(tmp_path, {"objects": ["meshes", "ycb"]}, ())
    assert dataset.objects == (str(tmp_path / "meshes"), "ycb")
