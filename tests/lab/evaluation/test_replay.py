"""A small dataset through estimators, in one process and in two."""

from dataclasses import replace
from pathlib import Path

import pytest

from igrip import Config, load_objects
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation.replay import run_dataset, run_trial


def test_a_straight_reach_is_right(small_dataset: Dataset) -> None:
    trial = small_dataset.trials[0]
    catalog = load_objects(*small_dataset.objects)
    result, intentions = run_trial(small_dataset, trial, catalog, Config(targets="distance"))
    assert result.problem is None
    assert result.score is not None
    assert result.score.success
    assert result.frames == len(intentions)
    assert intentions[-1].target == trial.target
    assert result.recorded == pytest.approx(2.0, abs=0.05)


def test_processes_change_nothing(small_dataset: Dataset) -> None:
    configs = [Config(targets="paper"), Config(targets="distance")]
    alone = list(run_dataset(small_dataset, configs, jobs=1, keep_intentions=True))
    together = list(run_dataset(small_dataset, configs, jobs=2, keep_intentions=True))
    assert alone == together
    assert [result.targets for result, _ in alone[0]] == ["paper", "distance"]


def test_what_is_wrong_with_a_trial_is_said(small_dataset: Dataset) -> None:
    catalog = load_objects(*small_dataset.objects)

    def problem(**changes: object) -> str | None:
        trial = replace(small_dataset.trials[0], **changes)
        return run_trial(small_dataset, trial, catalog, Config())[0].problem

    assert "no recording 'gone'" in (problem(recording="gone") or "")
    assert "'third' was never seen" in (problem(hand="third") or "")
    assert "onset and end" in (problem(end_s=None) or "")
    assert problem(target="none") is None


def test_a_malformed_recording_is_reported_and_the_rest_goes_on(small_dataset: Dataset) -> None:
    path = small_dataset.recording(small_dataset.trials[0])
    path.write_text('{"t": 0}\n{"t": -1}\n')
    first, second = (
        done[0][0] for done in run_dataset(small_dataset, [Config(targets="distance")])
    )
    assert first.problem == f"{path}, line 2: t: must not be negative, got -1"
    assert second.problem is None
    assert second.score is not None


def test_folders_of_meshes_travel_with_a_dataset(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    dataset = Dataset(tmp_path, {"objects": ["meshes", "ycb"]}, ())
    assert dataset.objects == (str(tmp_path / "meshes"), "ycb")
