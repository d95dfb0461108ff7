"""An evaluation of good and bad recordings: named, judged, resumed."""

import json
import shutil

import pytest

from igrip import Config
from igrip.errors import DatasetError
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation import experiment as module
from igrip.lab.evaluation.experiment import Experiment
from igrip.lab.evaluation.summary import frame_of, summarise
from igrip.lab.report.page import write_report
from igrip.lab.simulation.cohort import simulate
from igrip.lab.simulation.parameters import cohort
from igrip.objects.catalog import load_objects

TARGETS = ("paper", "distance")


@pytest.fixture(scope="session")
def simulated(tmp_path_factory):
    path = tmp_path_factory.mktemp("evaluated") / "cohort"
    list(simulate(path, load_objects("ycb"), cohort(), 2, 0, trials=4, no_reach_minutes=1))
    return path


@pytest.fixture
def dataset(simulated, tmp_path):
    return shutil.copytree(simulated, tmp_path / "cohort")


def run(path, out, jobs=1, targets=TARGETS):
    opened = Dataset.open(path, lenient=True)
    evaluation = Experiment(opened, [Config(targets=t) for t in targets], out)
    steps = list(evaluation.run(opened.trials, jobs))
    return evaluation, steps


def edit(path, change):
    table = path / "trials.tsv"
    header, *rows = [line.split("\t") for line in table.read_text().splitlines()]
    change(header, rows)
    table.write_text("".join("\t".join(line) + "\n" for line in [header, *rows]))


def test_rows_and_summary(dataset, tmp_path):
    evaluation, steps = run(dataset, tmp_path / "out")
    assert steps == list(range(18))
    assert len(evaluation.rows) == 2 * 17
    summary = summarise(frame_of(evaluation.rows), "x", TARGETS)
    assert (summary["recordings"], summary["reaches"], summary["excluded"]) == (17, 16, [])
    assert summary["no_reach_minutes"] == pytest.approx(1.0, abs=0.01)
    paper = summary["targets"]["paper"]
    assert paper["all"]["trials"] == 16
    assert 0.0 <= paper["all"]["success"] <= 1.0
    assert paper["no_reach"]["answers"] > 1000
    assert paper["calibration"] is None
    assert set(paper["by"]) >= {"view", "movement", "grip", "participant"}
    json.dumps(summary)  # plain data


def test_processes_change_nothing(dataset, tmp_path):
    one, _ = run(dataset, tmp_path / "one")
    two, _ = run(dataset, tmp_path / "two", jobs=2)
    key = lambda row: (row["recording"], row["targets"])  # noqa: E731
    assert sorted(one.rows, key=key) == sorted(two.rows, key=key)


def test_it_goes_on_where_it_was_interrupted(dataset, tmp_path, monkeypatch):
    whole, _ = run(dataset, tmp_path / "whole")
    opened = Dataset.open(dataset)
    first = Experiment(opened, [Config(targets=t) for t in TARGETS], tmp_path / "out")
    steps = first.run(opened.trials, 1)
    for _ in range(6):
        next(steps)
    steps.close()
    file = tmp_path / "out" / "rows.jsonl"
    file.write_bytes(file.read_bytes()[:-40])  # and its last line is cut
    done = []
    evaluate = module.evaluate_trial
    monkeypatch.setattr(
        module, "evaluate_trial", lambda d, t, c, s: done.append(t) or evaluate(d, t, c, s)
    )
    again, steps = run(dataset, tmp_path / "out")
    assert steps[0] == 4
    assert len(done) == 13
    assert again.rows == whole.rows
    done.clear()
    run(dataset, tmp_path / "out")
    assert done == []
    run(dataset, tmp_path / "out", targets=("paper",))  # another evaluation begins anew
    assert len(done) == 17


def test_bad_recordings_are_named_and_the_rest_is_judged(dataset, tmp_path):
    recordings = dataset / "recordings"
    names = [t.recording for t in Dataset.open(dataset).trials]
    (recordings / f"{names[0]}.jsonl").unlink()
    cut = recordings / f"{names[1]}.jsonl"
    cut.write_bytes(cut.read_bytes()[:-30])
    odd = recordings / f"{names[2]}.jsonl"
    odd.write_text(odd.read_text().replace("006_mustard_bottle", "no_such_model"))
    never = recordings / f"{names[3]}.jsonl"
    target = Dataset.open(dataset).trials[3].target
    never.write_text(never.read_text().replace(f'"{target}":', '"elsewhere":'))
    (recordings / f"{names[4]}.jsonl").write_text("")
    (recordings / f"{names[5]}.jsonl").write_text("this is no message\n")

    def change(header, rows):
        rows[6][header.index("onset_s")] = "nan"
        rows[7][header.index("target")] = ""

    edit(dataset, change)
    with (dataset / "participants.tsv").open("a") as file:
        file.write("p77\thealthy\n")
    evaluation, _ = run(dataset, tmp_path / "out")
    rows = {row["recording"]: row for row in evaluation.rows if row["targets"] == "paper"}
    told = [rows[name] for name in names[:8]]
    assert "no recording" in told[0]["problem"]
    assert told[1]["problem"] is None
    assert "line" in told[1]["remark"]
    assert told[2]["problem"] is None
    assert "no_such_model" in told[2]["remark"]
    assert told[3]["problem"] is None
    assert f"target {target!r} never appears" in told[3]["remark"]
    assert told[3]["success"] is False  # it counts
    assert told[4]["problem"] == "the recording is empty"
    assert told[5]["problem"]
    assert "line 8, onset_s: 'nan'" in told[6]["problem"]
    assert told[7]["problem"] == "its target is not known"
    summary = summarise(frame_of(evaluation.rows), "x", TARGETS)
    assert {e["recording"] for e in summary["excluded"]} == {names[k] for k in (0, 4, 5, 6, 7)}
    assert summary["reaches"] == 16 - 5
    assert all(e["problem"] for e in summary["excluded"])


def test_a_recording_that_was_mended_is_judged_anew(dataset, tmp_path):
    first = Dataset.open(dataset).trials[0]
    path = Dataset.open(dataset).recording(first)
    whole = path.read_bytes()
    path.write_bytes(whole[:2000])
    before, _ = run(dataset, tmp_path / "out")
    path.write_bytes(whole)
    after, steps = run(dataset, tmp_path / "out")
    assert steps[0] == 16
    assert before.rows[0] != after.rows[0]
    assert before.rows[2:] == after.rows[2:]


def test_part_of_a_larger_run_is_reported_alone(dataset, tmp_path):
    run(dataset, tmp_path / "out")
    opened = Dataset.open(dataset)
    part = Experiment(opened, [Config(targets=t) for t in TARGETS], tmp_path / "out")
    assert list(part.run(opened.trials[3:5], 1)) == [2]
    assert [row["recording"] for row in part.rows[::2]] == [
        trial.recording for trial in opened.trials[3:5]
    ]


def test_odd_rows_are_named(dataset, tmp_path):
    def change(header, rows):
        rows[1][header.index("recording")] = rows[0][header.index("recording")]
        rows[2][header.index("performed")] = "no"
        rows[3][header.index("end_s")] = ""
        rows[4][header.index("target")] = " none "

    edit(dataset, change)
    evaluation, _ = run(dataset, tmp_path / "out", targets=("paper",))
    told = evaluation.rows
    assert "is in an earlier line" in told[1]["problem"]
    assert told[2]["problem"] == "was not performed"
    assert "missing" in told[3]["remark"]
    assert told[4]["target"] == "none"
    with pytest.raises(DatasetError, match="earlier line"):
        Dataset.open(dataset)


def test_an_odd_recording_does_not_end_the_others(dataset, tmp_path, monkeypatch):
    def broken(*args):
        raise RuntimeError("of a kind that nobody foresaw")

    monkeypatch.setattr(module, "describe_trial", broken)
    evaluation, _ = run(dataset, tmp_path / "out", targets=("paper",))
    assert all("nobody foresaw" in row["problem"] for row in evaluation.rows)


@pytest.mark.parametrize("kept", ["none", "nothing", "one"])
def test_reports_of_small_and_empty_datasets(dataset, tmp_path, kept):
    def change(header, rows):
        column = header.index("target")
        if kept == "none":
            rows[:] = [row for row in rows if row[column] == "none"]
        else:
            rows[:] = rows[:1] if kept == "one" else []

    edit(dataset, change)
    evaluation, _ = run(dataset, tmp_path / "out")
    frame = frame_of(evaluation.rows)
    summary = summarise(frame, "x", TARGETS)
    opened = Dataset.open(dataset)
    write_report(tmp_path / "out", opened, load_objects("ycb"), frame, summary)
    assert "<h2>" in (tmp_path / "out" / "report.html").read_text()
    assert summary["recordings"] == {"none": 1, "nothing": 0, "one": 1}[kept]
