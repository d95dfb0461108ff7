"""Predictions during a trial: those of the estimator, recorded, and never in the way."""

import pytest

from igrip import Config, Estimator, load_objects, read_intentions
from igrip.experiment.cameras import CameraRecorder
from igrip.experiment.live_predictions import LivePredictions
from igrip.experiment.plan import draw_plan
from igrip.experiment.simulated import SimulatedRecorder
from igrip.experiment.study import StudyError, read_study
from igrip.io.recordings import open_source
from runtime_fakes import until
from small_study import FakeObserver, observation, small_study


@pytest.fixture
def folder(tmp_path):
    found = small_study(tmp_path / "study")
    path = found.path / "study.toml"
    path.write_text(path.read_text().replace("[factors]", 'predictions = "distance"\n\n[factors]'))
    return found.path


def expected(path, study):
    estimator = Estimator(load_objects(*study.models), Config(targets="distance"))
    return [one for message in open_source(path) for one in estimator.update(message)]


def test_a_simulated_trial_holds_what_the_estimator_says_of_it(folder, tmp_path):
    study = read_study(folder)
    recorder = SimulatedRecorder(study, load_objects(*study.models), "P01")
    for trial in draw_plan(study, "P01").trials[:2]:
        files = {name: tmp_path / f"{trial.number}_{name}.mcap" for name in study.cameras}
        recorder.start(trial, 1, files)
        recorder.stop()
        for path in files.values():
            said = list(read_intentions(path))
            assert said == expected(path, study)
            assert {one.target for one in said} - {None} <= set(study.objects)


def test_cameras_record_it_too_and_survive_a_clock_that_goes_back(folder, tmp_path):
    study = read_study(folder)
    observers = {name: FakeObserver() for name in study.cameras}
    recorder = CameraRecorder(study, observers, catalog=load_objects(*study.models))
    files = {name: tmp_path / f"{name}.mcap" for name in observers}
    trial = draw_plan(study, "P01").trials[0]
    recorder.start(trial, 1, files)
    for t in (1.0, 1.1, 1.2, 0.5, 0.6):
        for camera, observer in observers.items():
            observer.put(observation(t))
            until(lambda c=camera, t=t: recorder._one[c]._t == t)
    assert recorder.failure() is None
    recorder.stop()
    recorder.close()
    for path in files.values():
        assert [one.t for one in open_source(path)] != []
        said = read_intentions(path)
        assert {one.hand for one in said} == {"right"}
        assert len(said) == 4  # the one that went back is left out


def test_without_it_nothing_is_predicted(tmp_path):
    study = small_study(tmp_path / "study").study
    assert LivePredictions(study, load_objects(*study.models)).of(observation(1.0)) == []


def test_a_misspelt_estimator_is_answered_with_the_one_that_was_meant(folder):
    path = folder / "study.toml"
    path.write_text(path.read_text().replace('"distance"', '"distanze"'))
    with pytest.raises(StudyError, match=r"study\.toml.*did you mean 'distance'"):
        read_study(folder)
