"""An evaluation that is kept, resumed, and done again where something changed."""

import json
import math
import shutil

import pytest
import trimesh

from datasets import write_small_dataset
from igrip import Config
from igrip.errors import DatasetError, RecordingError
from igrip.io.datasets import dataset as dataset_module
from igrip.io.datasets.dataset import Dataset
from igrip.lab import parallel
from igrip.lab.evaluation import evaluation as module
from igrip.lab.evaluation import fingerprint, runner
from igrip.lab.evaluation.evaluation import Evaluation
from igrip.lab.parallel import Workers
from igrip.lab.simulation.cohort import simulate_cohort
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.objects.catalog import load_objects

TARGETS = ("paper", "distance")


@pytest.fixture(scope="session")
def simulated(tmp_path_factory):
    path = tmp_path_factory.mktemp("evaluated") / "cohort"
    list(
        simulate_cohort(
            path, load_objects("ycb"), cohort_parameters(), 2, 0, trials=2, no_reach_minutes=1
        )
    )
    return path


@pytest.fixture
def dataset(simulated, tmp_path):
    return shutil.copytree(simulated, tmp_path / "cohort")


def run(path, out, jobs=1, targets=TARGETS):
    opened = Dataset.open(path, lenient=True)
    evaluation = Evaluation(opened, [Config(targets=t) for t in targets], out)
    steps = list(evaluation.run(opened.trials, Workers(jobs)))
    return list(evaluation.rows), steps


def edit(path, change):
    table = path / "trials.tsv"
    header, *rows = [line.split("\t") for line in table.read_text().splitlines()]
    change(header, rows)
    table.write_text("".join("\t".join(line) + "\n" for line in [header, *rows]))


def test_rows_of_every_trial_and_estimator(dataset, tmp_path):
    rows, steps = run(dataset, tmp_path / "out")
    assert steps == list(range(10))
    assert [(row["row"], row["targets"]) for row in rows] == [
        (k, targets) for k in range(9) for targets in TARGETS
    ]
    lines = (tmp_path / "out" / "rows.jsonl").read_text().splitlines()
    assert [json.loads(line) for line in lines[1:]] == rows


def test_processes_change_nothing(dataset, tmp_path, monkeypatch):
    monkeypatch.setattr(parallel, "MIN_ITEMS", 1)
    one, _ = run(dataset, tmp_path / "one")
    two, _ = run(dataset, tmp_path / "two", jobs=2)
    assert one == two


@pytest.fixture
def evaluated(monkeypatch):
    """Note the trials that are run."""
    names = []
    run_trial = runner.run_trial

    def note(dataset, trial, catalog, configs):
        names.append(trial.recording)
        return run_trial(dataset, trial, catalog, configs)

    monkeypatch.setattr(runner, "run_trial", note)
    return names


def test_it_goes_on_where_it_was_interrupted(dataset, tmp_path, evaluated):
    whole, _ = run(dataset, tmp_path / "whole")
    opened = Dataset.open(dataset)
    first = Evaluation(opened, [Config(targets=t) for t in TARGETS], tmp_path / "out")
    steps = first.run(opened.trials, Workers())
    for _ in range(5):
        next(steps)
    steps.close()
    file = tmp_path / "out" / "rows.jsonl"
    file.write_bytes(file.read_bytes()[:-40])  # and its last line is cut
    evaluated.clear()
    again, steps = run(dataset, tmp_path / "out")
    assert steps[0] == 3
    assert len(evaluated) == 6
    assert again == whole
    evaluated.clear()
    once_more, steps = run(dataset, tmp_path / "out")
    assert (steps, evaluated) == ([9], [])
    assert once_more == whole
    run(dataset, tmp_path / "out", targets=("paper",))  # another evaluation begins anew
    assert len(evaluated) == 9


def test_a_recording_that_was_mended_is_judged_anew(dataset, tmp_path):
    first = Dataset.open(dataset).trials[0]
    path = Dataset.open(dataset).recording(first)
    whole = path.read_bytes()
    path.write_bytes(whole[:2000])
    before, _ = run(dataset, tmp_path / "out")
    path.write_bytes(whole)
    after, steps = run(dataset, tmp_path / "out")
    assert steps[0] == 8
    assert before[0] != after[0]
    assert before[2:] == after[2:]


def test_part_of_a_larger_run_is_reported_alone(dataset, tmp_path):
    run(dataset, tmp_path / "out")
    opened = Dataset.open(dataset)
    part = Evaluation(opened, [Config(targets=t) for t in TARGETS], tmp_path / "out")
    assert list(part.run([opened.trials[4], opened.trials[3]], Workers())) == [2]
    assert [row["recording"] for row in list(part.rows)[::2]] == [
        trial.recording for trial in opened.trials[3:5]
    ]


def write_mesh(folder, radius):
    folder.mkdir(exist_ok=True)
    trimesh.creation.cylinder(radius, 0.12, sections=32).export(folder / "can.stl")


@pytest.fixture
def with_meshes(tmp_path):
    """A dataset whose objects are a mesh in its own folder."""
    path = write_small_dataset(tmp_path / "small").path
    write_mesh(path / "meshes", 0.03)
    description = json.loads((path / "dataset.json").read_text()) | {"objects": ["meshes"]}
    (path / "dataset.json").write_text(json.dumps(description))
    for recording in (path / "recordings").iterdir():
        recording.write_text(recording.read_text().replace("cylinder:0.03x0.12", "can"))
    return path


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_mesh_that_was_changed_is_evaluated_anew(with_meshes, tmp_path, monkeypatch, jobs):
    """Neither rows of an earlier evaluation nor models kept in a process may be stale."""
    monkeypatch.setattr(parallel, "MIN_ITEMS", 1)
    before, _ = run(with_meshes, tmp_path / "out", jobs)
    write_mesh(with_meshes / "meshes", 0.15)
    after, steps = run(with_meshes, tmp_path / "out", jobs)
    assert steps[0] == 0
    assert before != after
    assert run(with_meshes, tmp_path / "fresh")[0] == after


def test_what_is_declared_of_a_mesh_is_evaluated_anew(with_meshes, tmp_path):
    run(with_meshes, tmp_path / "out", targets=("distance",))
    (with_meshes / "meshes" / "objects.toml").write_text('[can]\nsymmetry = "box"\n')
    assert run(with_meshes, tmp_path / "out", targets=("distance",))[1][0] == 0


def test_weights_that_were_trained_anew_are_evaluated_anew(with_meshes, tmp_path, monkeypatch):
    package = tmp_path / "package"
    package.mkdir()
    monkeypatch.setattr(fingerprint, "PACKAGE", package)
    (package / "weights.json").write_text("[1]")
    run(with_meshes, tmp_path / "out", targets=("distance",))
    assert run(with_meshes, tmp_path / "out", targets=("distance",))[1][0] == 2
    (package / "weights.json").write_text("[2]")
    assert run(with_meshes, tmp_path / "out", targets=("distance",))[1][0] == 0


def test_other_objects_than_the_dataset_s(with_meshes, tmp_path):
    opened = Dataset.open(with_meshes)
    evaluation = Evaluation(
        opened, [Config(targets="distance")], tmp_path / "out", ["box:0.1x0.1x0.1"]
    )
    list(evaluation.run(opened.trials, Workers()))
    assert all("'can'" in row["remark"] for row in evaluation.rows)
    assert list(evaluation.catalog) == ["box:0.1x0.1x0.1"]
    assert run(with_meshes, tmp_path / "out", targets=("distance",))[1][0] == 0


def test_a_recording_that_changes_while_it_is_read_is_read_again(
    with_meshes, tmp_path, monkeypatch
):
    open_source, changed = dataset_module.open_source, []

    def opened_and_changed(path, frame):
        reader = type("Reader", (list,), {"cut": None})(open_source(path, frame))
        if not changed:
            path.write_bytes(path.read_bytes() + b'{"t": 9}\n')
            changed.append(path)
        return reader

    monkeypatch.setattr(dataset_module, "open_source", opened_and_changed)
    run(with_meshes, tmp_path / "out", targets=("distance",))
    rows, steps = run(with_meshes, tmp_path / "out", targets=("distance",))
    assert steps[0] == 1
    assert rows[0]["messages"] == 62


def test_numbers_that_are_none_are_not_kept(with_meshes, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "score_run", lambda run: [{"targets": "distance", "x": math.nan}])
    with pytest.raises(ValueError, match="not JSON compliant"):
        run(with_meshes, tmp_path / "out", targets=("distance",))


def test_a_folder_that_cannot_be_written(with_meshes, tmp_path, monkeypatch):
    opened = Dataset.open(with_meshes)
    evaluation = Evaluation(opened, [Config(targets="distance")], tmp_path / "out")
    steps = evaluation.run(opened.trials, Workers())
    next(steps)
    shutil.rmtree(tmp_path / "out")
    with pytest.raises(RecordingError, match=r"rows\.jsonl: No such file"):
        next(steps)


def test_odd_rows_are_named(dataset, tmp_path):
    def change(header, rows):
        rows[1][header.index("recording")] = rows[0][header.index("recording")]
        rows[2][header.index("performed")] = "no"
        rows[3][header.index("end_s")] = ""
        rows[4][header.index("target")] = " none "
        rows[5][header.index("onset_s")] = "nan"
        rows[6][header.index("target")] = ""

    edit(dataset, change)
    rows, _ = run(dataset, tmp_path / "out", targets=("paper",))
    assert "is in an earlier line" in rows[1]["problem"]
    assert rows[2]["problem"] == "was not performed"
    assert "missing" in rows[3]["remark"]
    assert rows[4]["target"] == "none"
    assert "line 7, onset_s: 'nan'" in rows[5]["problem"]
    assert rows[6]["problem"] == "its target is not known"
    with pytest.raises(DatasetError):
        Dataset.open(dataset)


def test_bad_recordings_are_named_and_the_rest_is_judged(dataset, tmp_path):
    recordings, trials = dataset / "recordings", Dataset.open(dataset).trials
    files = [recordings / f"{trial.recording}.jsonl" for trial in trials]
    files[0].unlink()
    files[1].write_bytes(files[1].read_bytes()[:-30])
    files[2].write_text(files[2].read_text().replace("006_mustard_bottle", "no_such_model"))
    files[3].write_text(files[3].read_text().replace(f'"{trials[3].target}":', '"elsewhere":'))
    files[4].write_text("")
    files[5].write_text("this is no message\n")
    rows, _ = run(dataset, tmp_path / "out", targets=("paper",))
    problems, remarks = ([row[key] for row in rows] for key in ("problem", "remark"))
    assert "no recording" in problems[0]
    assert problems[1:4] == [None] * 3
    assert "line" in remarks[1]
    assert "no_such_model" in remarks[2]
    assert f"target {trials[3].target!r} never appears" in remarks[3]
    assert rows[3]["success"] is False  # it counts
    assert problems[4] == "the recording is empty"
    assert problems[5]
    assert problems[6:] == [None] * 3
