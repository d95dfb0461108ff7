"""From a run to its rows: one for each estimator, with problems and remarks."""

from dataclasses import replace

import pytest

from igrip import Config, load_objects
from igrip.lab.evaluation import trial_rows
from igrip.lab.evaluation.commitments import first_commitments
from igrip.lab.evaluation.predicted_times import contact_time, score_times
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.trial_description import describe_trial
from igrip.lab.evaluation.trial_metrics import score_answers
from igrip.lab.evaluation.trial_rows import score_run

CONFIGS = (Config(targets="distance"), Config(targets="paper"))


@pytest.fixture
def run(small_dataset):
    def run(**changes):
        trial = replace(small_dataset.trials[0], **changes)
        catalog = load_objects(*small_dataset.objects)
        return run_trial(small_dataset, trial, catalog, CONFIGS)

    return run


def test_a_row_is_put_together_from_description_scores_and_commitments(run):
    done = run()
    rows = score_run(done)
    assert [row["targets"] for row in rows] == ["distance", "paper"]
    for row, estimator in zip(rows, done.estimators, strict=True):
        expected = {"targets": row["targets"], "problem": None, "remark": None}
        expected |= describe_trial(done.recorded, (1.0, 2.0), done.objects)
        expected |= score_answers(done.trial, (1.0, 2.0), estimator.intentions, 2.0)
        expected |= score_times(
            "right", "near", (1.0, 2.0), contact_time(done.recorded, (1.0, 2.0)),
            estimator.intentions, 2.0,
        )  # fmt: skip
        plain = score_run(done, commitments=False)[rows.index(row)]
        assert plain == expected
        commitment = estimator.config.commitment
        assert row == plain | first_commitments(
            estimator.evidence, commitment, "right", "near", (1.0, 2.0)
        )
    assert rows[0]["success"] is True
    assert rows[0]["depth_gap_m"] is not None
    assert rows[0]["commit_right"][0] is True
    # 8 cm before the surface is 3 cm before the end of a reach of 17 cm
    assert 1.5 < rows[0]["contact_s"] < 2.0


def test_the_end_of_the_recording_counts(run):
    """It ends at 2.0 s, the movement at 2.08 s or at 2.2 s."""
    assert score_run(run(end_s=2.08))[0]["right_at_100%"]
    late = score_run(run(end_s=2.2))[0]
    assert not late["right_at_100%"]
    assert not late["success"]
    assert late["remark"] == "the recording ends before the movement does"


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"recording": "gone"}, "no recording 'gone'"),
        ({"problem": "line 3 is wrong"}, "line 3 is wrong"),
        ({"hand": None}, "its hand is not known"),
        ({"hand": "third", "end_s": None}, "its movement has no onset and end"),
        ({"performed": "no"}, "was not performed"),
    ],
)
def test_problems(run, changes, problem):
    for row, targets in zip(score_run(run(**changes)), ("distance", "paper"), strict=True):
        assert problem in row["problem"]
        assert (row["targets"], row["remark"]) == (targets, None)
        assert row["participant"] == "p1"
        assert "success" not in row


def test_a_hand_that_was_never_seen_is_a_failure(run):
    row = score_run(run(hand="third"))[0]
    assert row["problem"] is None
    assert row["remark"] == "hand 'third' was never seen"
    assert row["success"] is False


def test_without_a_reach(run):
    row = score_run(run(target="none"))[0]
    assert row["problem"] is None
    assert row["commits"][0] > 0
    assert "onset_s" not in row
    assert row["named"] > 0


def test_remarks_of_the_recording(run, small_dataset):
    path = small_dataset.recording(small_dataset.trials[0])
    path.write_text(path.read_text().replace("cylinder:0.03x0.12", "unknown", 1)[:-9])
    row = score_run(run(camera_side="top"))[0]
    unknown, side, cut = row["remark"].split("; ", 2)
    assert "'unknown'" in unknown
    assert side == "camera_side 'top' is neither left nor right"
    assert "cut off in line 61" in cut


def test_an_odd_trial_ends_only_itself(run, monkeypatch):
    def broken(*args):
        raise RuntimeError("of a kind that nobody foresaw")

    monkeypatch.setattr(trial_rows, "describe_trial", broken)
    problem = "cannot be evaluated: RuntimeError('of a kind that nobody foresaw')"
    base = {"recording": "reach0", "participant": "p1", "target": "near", "hand": "right"}
    assert score_run(run()) == [
        base | {"targets": targets, "problem": problem} for targets in ("distance", "paper")
    ]
