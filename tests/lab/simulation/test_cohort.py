"""The simulated cohort: the paper's protocol, the same for the same seed, and never tuned."""

from collections import Counter

import numpy as np
import pytest

from igrip.errors import DatasetError
from igrip.io.datasets.dataset import Dataset
from igrip.io.recordings.jsonl import JsonlReader
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.evaluation.trial_description import describe_trial
from igrip.lab.parallel import ALONE, Workers
from igrip.lab.simulation.cohort import rest_points, simulate_cohort, tasks_of
from igrip.lab.simulation.no_reach import KINDS, draw_no_reach
from igrip.lab.simulation.parameters import ProtocolParameters, checksum, cohort_parameters
from igrip.lab.simulation.table import models_by_id, set_table

FROZEN = {"healthy": "ed681f0a9273a61e", "stroke": "3bd7bb53368cd2db", "sci": "7ad3dcb15aa0f7e6"}


@pytest.mark.parametrize("profile", FROZEN)
def test_the_parameters_stand_as_they_were_before_any_estimator_was_run(profile):
    assert checksum(cohort_parameters(profile)) == FROZEN[profile]


def test_every_parameter_has_a_source_and_a_unit():
    for part in ("protocol", "person", "camera"):
        for name, field in type(getattr(cohort_parameters(), part)).model_fields.items():
            assert field.json_schema_extra["source"], name
            assert field.json_schema_extra["unit"], name


def test_the_protocol_of_a_participant():
    tasks = tasks_of(ProtocolParameters(), np.random.default_rng(0))
    assert len(tasks) == 128
    assert set(Counter(tasks).values()) == {4}
    assert len(Counter(tasks)) == 32
    assert tasks != tasks_of(ProtocolParameters(), np.random.default_rng(1))


@pytest.fixture(scope="module")
def small(ycb, tmp_path_factory):
    path = tmp_path_factory.mktemp("cohort") / "small"
    steps = list(
        simulate_cohort(
            path, ycb, cohort_parameters(), participants=3, trials=12, no_reach_minutes=4
        )
    )
    assert steps[-1] == (3 * 12 * 2 + 4, 3 * 12 * 2 + 4)
    return Dataset.open(path)


def test_rows_of_the_table(small):
    assert len(small.trials) == 76
    reaches = [t for t in small.trials if t.target != "none"]
    assert Counter(t.camera_side for t in reaches) == {"left": 36, "right": 36}
    pairs = list(zip(reaches[::2], reaches[1::2], strict=True))
    for left, right in pairs:  # both cameras see the same movement
        assert (left.onset_s, left.end_s, left.target) == (right.onset_s, right.end_s, right.target)
    assert {t.movement for t in small.trials if t.target == "none"} == set(KINDS)


@pytest.mark.parametrize("workers", [ALONE, Workers(2)], ids=["alone", "two processes"])
def test_the_same_seed_gives_the_same_bytes(small, ycb, tmp_path, workers):
    list(
        simulate_cohort(
            tmp_path / "again",
            ycb,
            cohort_parameters(),
            participants=3,
            trials=12,
            no_reach_minutes=4,
            workers=workers,
        )
    )
    assert Dataset.open(tmp_path / "again").trials == small.trials
    for trial in small.trials:
        again = Dataset.open(tmp_path / "again").recording(trial)
        assert again.read_bytes() == small.recording(trial).read_bytes()


@pytest.mark.parametrize("after", [1, 2, 7])
def test_an_interrupted_simulation_goes_on(ycb, tmp_path, monkeypatch, after):
    def simulated(path, trials=4):
        return simulate_cohort(path, ycb, cohort_parameters(), 2, 0, trials, 2)

    list(simulated(tmp_path / "whole"))
    begun = simulated(tmp_path / "cut")
    for _ in range(after):
        next(begun)
    with pytest.raises(DatasetError, match="another process writes it"):
        next(simulated(tmp_path / "cut"))
    begun.close()
    (tmp_path / ".cut-unfinished" / "recordings" / "p02_t004_right.jsonl").write_text("half a l")
    assert next(simulated(tmp_path / "cut")) == (after, 18)
    steps = list(simulated(tmp_path / "cut"))
    assert steps == [(k, 18) for k in range(after, 19)]
    whole, cut = (
        {path.relative_to(tmp_path / name): path.read_bytes()
         for path in sorted((tmp_path / name).rglob("*")) if path.is_file()}
        for name in ("whole", "cut")
    )  # fmt: skip
    assert cut == whole
    assert [path.name for path in tmp_path.iterdir() if path.name[0] == "."] == []


def test_an_unfinished_simulation_of_something_else_is_forgotten(ycb, tmp_path):
    for seed in (1, 0):
        begun = simulate_cohort(tmp_path / "cut", ycb, cohort_parameters(), 1, seed, 2, 0)
        assert next(begun) == (1, 4)
        begun.close()
    assert next(simulate_cohort(tmp_path / "cut", ycb, cohort_parameters(), 1, 0, 1, 0)) == (1, 2)


def test_another_participant_count_keeps_the_people(small, ycb, tmp_path):
    list(
        simulate_cohort(
            tmp_path / "one", ycb, cohort_parameters(), participants=1, trials=2, no_reach_minutes=0
        )
    )
    one = Dataset.open(tmp_path / "one")
    for trial in one.trials:
        assert one.recording(trial).read_bytes() == small.recording(trial).read_bytes()


def test_it_looks_like_the_paper_s_recordings(small):
    """About 90 % of frames observed, 57 % of trials valid, 1.19 s a movement; 72 trials here."""
    rows = []
    for trial in small.trials:
        if trial.target == "none":
            continue
        recorded = RecordedTrial(trial)
        for observation in JsonlReader(small.recording(trial)):
            recorded.add(observation)
        rows.append(describe_trial(recorded, recorded.bounds(), []))
    assert np.mean([row["observed"] for row in rows]) == pytest.approx(0.90, abs=0.03)
    assert 0.40 < np.mean([row["valid"] for row in rows]) < 0.75
    assert np.mean([row["movement_s"] for row in rows]) == pytest.approx(1.19, abs=0.15)


@pytest.mark.parametrize("kind", KINDS)
def test_scenes_without_a_reach(ycb, kind):
    random = np.random.default_rng(1)
    table = set_table(models_by_id(ycb), ProtocolParameters(), random)
    scene = draw_no_reach(
        kind, table, cohort_parameters(), rest_points(ProtocolParameters()), 30.0, random
    )
    palm = scene.palms[scene.hand]
    speed = np.linalg.norm(np.diff(palm, axis=0), axis=1) * 30
    assert speed.max() < 3.0
    if kind == "idle":
        assert np.ptp(palm, axis=0).max() < 0.15
    else:
        assert speed.max() > 0.2
    assert (kind == "carrying") == bool(scene.moving)
    if kind == "carrying":
        [(_id, pose)] = scene.moving.items()
        places = np.array([pose(t)[1] for t in scene.times])
        held = palm - places
        assert np.ptp(held, axis=0).max() < 0.02  # it goes where the palm goes
        assert np.ptp(places, axis=0).max() > 0.1


def test_objects_stand_apart_on_the_table(ycb):
    models = models_by_id(ycb)
    for seed in range(30):
        table = set_table(models, ProtocolParameters(), np.random.default_rng(seed))
        spots = np.array([table.middle(id)[:2] for id in models])
        gaps = np.linalg.norm(spots[:, None] - spots[None], axis=2)[np.triu_indices(4, 1)]
        assert gaps.min() >= 0.17 - 1e-9
        for id, model in models.items():
            height = (model.vertices @ table.rotation(id).T + table.places[id])[:, 2]
            assert height.min() == pytest.approx(0.0, abs=1e-9)
            assert (
                table.grasp_point(id, "pinch", np.zeros(3), ProtocolParameters())[2] > height.max()
            )


def test_nobody(ycb, tmp_path):
    with pytest.raises(DatasetError, match="participant"):
        list(simulate_cohort(tmp_path / "none", ycb, cohort_parameters(), participants=0))
