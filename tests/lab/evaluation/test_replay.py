"""A dataset replayed and summed up: the same numbers as those of an evaluation."""

from dataclasses import replace

import pytest

from igrip import Config, load_objects
from igrip.lab.evaluation.averages import average_scores
from igrip.lab.evaluation.predicted_times import summarise_times
from igrip.lab.evaluation.replay import ReplayedTrial, replay_run, summarise_replay
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.trial_metrics import FRACTIONS
from igrip.lab.evaluation.trial_rows import score_run

CONFIGS = (Config(targets="distance"), Config(targets="paper"))


@pytest.fixture
def run(small_dataset):
    def run(number=0, **changes):
        trial = replace(small_dataset.trials[number], **changes)
        catalog = load_objects(*small_dataset.objects)
        return run_trial(small_dataset, trial, catalog, CONFIGS)

    return run


def test_rows_are_those_of_an_evaluation(run):
    done = run()
    replayed = replay_run(done)
    assert replayed.rows == score_run(done, commitments=False)
    evaluated = score_run(done)
    for row, more in zip(replayed.rows, evaluated, strict=True):
        assert row.items() <= more.items()
    assert (replayed.intentions, replayed.cut) == ([[], []], None)
    done.cut = "cut off"
    kept = replay_run(done, keep_intentions=True)
    assert kept.cut == "cut off"
    assert kept.intentions == [e.intentions for e in done.estimators]


def test_a_trial_without_a_task_is_no_problem(run):
    for changes in ({"target": None}, {"performed": "no"}, {"target": "none"}):
        assert [row["problem"] for row in replay_run(run(**changes)).rows] == [None, None]
    for changes in ({"hand": None}, {"target": None, "recording": "gone"}):
        assert None not in [row["problem"] for row in replay_run(run(**changes)).rows]


def test_summary(run, small_dataset):
    trials = [replay_run(run(0)), replay_run(run(1)), replay_run(run(1, recording="reach0"))]
    derived = replace(small_dataset, description={"name": "Small", "derived": {"a": 1}})
    summary = summarise_replay(derived, trials)
    assert (summary["dataset"], summary["derived"]) == ("Small", {"a": 1})
    assert (summary["trials"], summary["participants"]) == (2, 1)
    assert (summary["problems"], summary["remarks"], summary["cut"]) == ([], [], [])
    names = [(row["targets"], row["group"], row["trials"]) for row in summary["results"]]
    assert names == [
        (targets, group, trials) for targets in ("distance", "paper")
        for group, trials in (("all", 3), ("far", 2), ("near", 1))
    ]  # fmt: skip
    rows = [trial.rows[1] for trial in trials]
    expected = average_scores({key: [row[key] for row in rows] for key in rows[0]})
    paper = summary["results"][3]
    assert paper == {
        "targets": "paper", "group": "all", "trials": 3, "success": expected["success"],
        "accuracy_40%": expected["accuracy"]["40%"], "accuracy_60%": expected["accuracy"]["60%"],
        **{key: expected[key] for key in ("delay_s", "delay_clipped_s", "margin_s")},
        "times": summarise_times({key: [row[key] for row in rows] for key in rows[0]}),
    }  # fmt: skip
    assert paper["success"] is not None


def row(recording, targets="paper", **more):
    scores = {"success": True, "delay_s": 0.1, "delay_clipped_s": 0.1, "margin_s": 0.5}
    scores |= {f"right_at_{f:.0%}": True for f in FRACTIONS}
    base = {"recording": recording, "participant": "p", "trial": "1", "targets": targets,
            "problem": None, "remark": None, "group": None}  # fmt: skip
    return base | scores | more


def test_problems_remarks_and_cuts(small_dataset):
    broken = {"recording": "c", "participant": None, "targets": "paper", "problem": "is gone"}
    trials = [
        ReplayedTrial([row("a", remark="odd")], [[]], "cut in line 3"),
        ReplayedTrial([row("b", success=False, participant="q")], [[]], "cut in line 2"),
        ReplayedTrial([broken], [[]], None),
    ]
    summary = summarise_replay(small_dataset, trials)
    assert (summary["trials"], summary["participants"]) == (3, 2)
    assert summary["remarks"] == [{"recording": "a", "remark": "odd"}]
    assert summary["problems"] == [
        {"recording": "c", "trial": None, "targets": "paper", "problem": "is gone"}
    ]
    assert summary["cut"] == ["cut in line 2", "cut in line 3"]
    [result] = summary["results"]
    assert (result["trials"], result["success"]) == (2, 0.5)


def test_nothing_to_score(small_dataset):
    none = {"recording": "a", "participant": "p", "targets": "paper", "problem": None}
    summary = summarise_replay(small_dataset, [ReplayedTrial([none], [[]], None)])
    assert summary["results"] == [{"targets": "paper", "group": "all", "trials": 0}]
    assert summarise_replay(small_dataset, [])["results"] == []
