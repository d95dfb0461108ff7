"""The rows of an evaluation summed up, each number counted by hand."""

import json
import math

import numpy as np
import pandas as pd
import pytest

from igrip.commitment import CommitmentConfig
from igrip.lab.evaluation.averages import TIMES
from igrip.lab.evaluation.calibration import interval_over_groups
from igrip.lab.evaluation.commitments import RELIABILITIES
from igrip.lab.evaluation.summary import frame_of, reaches_of, scores, summarise, valid_of
from igrip.lab.evaluation.trial_metrics import FRACTIONS

PARTS = [f"{f:.0%}" for f in FRACTIONS]


def reach(recording="r", success=True, grip=None, **more):
    """Return a row of a reach; with ``grip``, whether that was found."""
    row = {
        "recording": recording, "participant": "p", "targets": "paper", "target": "cup",
        "problem": None, "remark": None, "valid": True, "invalid_reason": None, "group": None,
        "view": "ipsi", "movement": "executed", "hand": "right", "grip": None, "messages": 10,
        "observed": 0.5, "objects": 4, "seconds": 2.0, "both_seen_0.3s_before_end": True,
        "bounds": "table", "movement_s": 1.0, "angular_gap_deg": 15.0, "depth_gap_m": 0.05,
        "success": success, "delay_s": -0.1, "delay_clipped_s": 0.0, "margin_s": 0.7,
        "frames_possible": 10, "frames_right": 6,
    }  # fmt: skip
    row |= {f"right_at_{part}": success for part in PARTS}
    if grip is not None:
        row |= {"grip": "pinch", "grip_success": grip, "grip_delay_s": 0.2, "grip_margin_s": 0.4,
                "grip_delay_clipped_s": 0.2, "grip_frames_right": 8}  # fmt: skip
        row |= {f"grip_right_at_{part}": grip for part in PARTS}
    return row | more


def no_reach(**more):
    row = {
        "recording": "n", "participant": "p", "targets": "paper", "target": "none",
        "problem": None, "seconds": 90.0, "messages": 100, "observed": 1.0, "answers": 10,
        "named": 4, "reaching": 5, "named_reaching": 3, "with_probability": 0,
        "none_most_probable": 0, "movement": "idle", "commits": [1] * 12,
    }  # fmt: skip
    return row | more


def summary_of(*rows, targets=("paper",)):
    return summarise(frame_of(rows), "set", targets)


def test_reaches_and_what_is_left_out():
    broken = {"recording": "b", "participant": None, "targets": "paper", "target": "cup",
              "problem": "is gone"}  # fmt: skip
    summary = summary_of(
        reach(messages=30, observed=1.0), reach("i", valid=False, invalid_reason="hand never found",
        remark="odd", bounds="trace", movement_s=2.0), reach("j"),
        no_reach(), no_reach(seconds=30.0), no_reach(problem="is gone, too", recording="m"), broken,
        reach("other", targets="distance", remark="not counted twice"),
    )  # fmt: skip
    assert (summary["schema"], summary["dataset"]) == ("igrip-summary/1", "set")
    assert (summary["recordings"], summary["reaches"], summary["valid"]) == (7, 3, 2)
    assert summary["valid_share"] == pytest.approx(2 / 3)
    assert summary["excluded"] == [
        {"recording": "m", "participant": "p", "problem": "is gone, too"},
        {"recording": "b", "participant": "unknown", "problem": "is gone"},
    ]
    assert summary["remarks"] == [{"recording": "i", "remark": "odd"}]
    assert summary["invalid_reasons"] == {"hand never found": 1}
    assert summary["observed_share"] == pytest.approx((30 + 5 + 5) / 50)
    assert summary["bounds_from_trace"] == 1
    assert summary["movement_s"] == pytest.approx(4 / 3)
    assert summary["no_reach_minutes"] == 2.0
    assert list(summary["targets"]) == ["paper"]
    paper = summary["targets"]["paper"]
    assert [paper[key]["trials"] for key in ("valid", "all", "seen_in_time")] == [2, 3, 3]
    json.dumps(summary)  # plain data


def test_an_empty_dataset():
    summary = summary_of()
    assert (summary["recordings"], summary["valid_share"], summary["movement_s"]) == (0, None, None)
    assert summary["observed_share"] is None
    paper = summary["targets"]["paper"]
    assert paper["valid"] == {
        "trials": 0, "frames": None, "success": None, "success_interval": None, "delay_s": None,
        "delay_clipped_s": None, "margin_s": None,
    }  # fmt: skip
    assert (paper["by"], paper["no_reach"], paper["calibration"]) == ({}, {}, None)
    assert paper["commitment"] == {"all": [], "valid": []}
    assert paper["participants"] == paper["by_objects"] == paper["by_angular_gap_deg"] == {}


def test_each_estimator_has_its_own_numbers():
    both = [reach(), reach(targets="distance", success=False)]
    targets = summary_of(*both, targets=("distance", "paper"))["targets"]
    assert list(targets) == ["distance", "paper"]
    assert (targets["distance"]["all"]["success"], targets["paper"]["all"]["success"]) == (0.0, 1.0)
    apart = summary_of(reach(), no_reach(targets="distance"), targets=("paper", "distance"))
    assert apart["targets"]["paper"]["no_reach"] == {}
    assert apart["targets"]["distance"]["no_reach"]["answers"] == 10


def test_scores_by_hand():
    rows = frame_of([
        reach("a", True, grip=True, frames_right=9), reach("b", False, grip=True, delay_s=0.9),
        reach("c", True, delay_s=0.3, delay_clipped_s=0.3, frames_possible=20),
    ])  # fmt: skip
    result = scores(rows)
    assert result["trials"] == 3
    assert result["frames"] == pytest.approx((9 + 6 + 6) / 40)
    assert result["success"] == pytest.approx(2 / 3)
    assert result["delay_s"] == pytest.approx((-0.1 + 0.3) / 2)
    assert result["delay_clipped_s"] == pytest.approx(0.15)
    assert result["margin_s"] == pytest.approx(0.7)
    assert result["grip_frames"] == pytest.approx(16 / 20)  # of the two trials with a grip
    assert result["grip_success"] == 1.0
    assert result["grip_delay_s"] == pytest.approx(0.2)
    assert result["accuracy"] == dict.fromkeys(PARTS, pytest.approx(2 / 3))
    assert result["grip_accuracy"] == dict.fromkeys(PARTS, 1.0)
    assert result["success_interval"] is None  # of one person
    assert result["accuracy_interval"] == dict.fromkeys(PARTS)
    assert "grip_success" not in scores(frame_of([reach()]))
    invalid = summary_of(reach(grip=True, valid=False))["targets"]["paper"]
    assert set(invalid["valid"]) == {"trials", "success_interval", "success", "frames", *TIMES}
    assert invalid["all"]["grip_success"] == 1.0


def test_intervals_from_five_people_on():
    rows = [
        reach(f"{p}{k}", k % 2 == 0, participant=f"p{p}") for p in range(5) for k in range(p + 1)
    ]
    frame = frame_of(rows)
    values = frame["success"].astype(float).to_numpy()
    people = np.array([int(name[1:]) for name in frame["participant"]])
    result = scores(frame)
    assert tuple(result["success_interval"]) == interval_over_groups(values, people)
    assert result["accuracy_interval"]["40%"] == result["success_interval"]
    assert scores(frame[people < 4])["success_interval"] is None


def test_conditions():
    rows = [
        reach("a", True, grip=True, view="ipsi", group="near", objects=2, participant="q"),
        reach("b", False, grip=False, view="contra", group="near", objects=3),
        reach("c", True, view=None, group="far", objects=3),
        reach("d", False, view="ipsi", valid=False),
    ]
    paper = summary_of(*rows)["targets"]["paper"]
    by = paper["by"]
    assert set(by) == {"view", "movement", "grip", "hand", "target", "group", "participant"}
    assert by["view"] == {
        "contra": {"trials": 1, "success": 0.0, "grip_success": 0.0, "accuracy_40%": 0.0,
                   "accuracy_60%": 0.0},
        "ipsi": {"trials": 1, "success": 1.0, "grip_success": 1.0, "accuracy_40%": 1.0,
                 "accuracy_60%": 1.0},
    }  # fmt: skip
    assert by["group"]["far"] == {
        "trials": 1, "success": 1.0, "accuracy_40%": 1.0, "accuracy_60%": 1.0,
    }  # fmt: skip
    assert [by["participant"][name]["trials"] for name in ("p", "q")] == [2, 1]
    assert {name: one["trials"] for name, one in paper["by_objects"].items()} == {"2": 1, "3": 2}
    assert set(paper["commitment"]) == {"all", "valid", "group far", "group near"}
    assert "view" not in summary_of(reach(view=None))["targets"]["paper"]["by"]


def test_bins_of_gaps():
    rows = [
        reach("a", angular_gap_deg=0.0, depth_gap_m=-0.3),
        reach("b", False, angular_gap_deg=9.99, depth_gap_m=-0.1),
        reach("c", angular_gap_deg=10.0, depth_gap_m=0.0),
        reach("d", angular_gap_deg=None, depth_gap_m=None),
        reach("e", angular_gap_deg=179.0, depth_gap_m=0.4),
    ]
    paper = summary_of(*rows)["targets"]["paper"]
    angles, depths = paper["by_angular_gap_deg"], paper["by_depth_gap_m"]
    assert {name: one["trials"] for name, one in angles.items()} == {
        "0 to 10": 2, "10 to 20": 1, "40 to 180": 1,
    }  # fmt: skip
    assert angles["0 to 10"]["success"] == 0.5
    assert {name: one["trials"] for name, one in depths.items()} == {
        "-inf to -0.1": 1, "-0.1 to 0": 1, "0 to 0.1": 1, "0.1 to inf": 1,
    }  # fmt: skip


def test_means_of_participants():
    rows = [
        reach("a", True, grip=True), reach("b", False), reach("c", True, participant="q"),
        reach("d", True, participant="q"), reach("e", True, participant="q", valid=False),
    ]  # fmt: skip
    people = summary_of(*rows)["targets"]["paper"]["participants"]
    assert people["success"] == {
        "mean": 0.75, "sd": pytest.approx(math.sqrt(2 * 0.25**2)), "participants": 2,
    }  # fmt: skip
    assert people["grip_success"]["mean"] == 1.0
    one = summary_of(reach())["targets"]["paper"]["participants"]
    assert one == {"success": {"mean": 1.0, "sd": None, "participants": 1}}


def test_without_a_reach():
    plain = summary_of(no_reach(), no_reach(seconds=30.0, named=6))["targets"]["paper"]
    assert plain["no_reach"] == {
        "minutes": 2.0, "answers": 20, "target_named": 0.5, "target_named_while_moving": 0.6,
    }  # fmt: skip
    told = summary_of(no_reach(with_probability=8, none_most_probable=6), no_reach())
    assert told["targets"]["paper"]["no_reach"]["none_most_probable"] == 0.75
    still = summary_of(no_reach(reaching=0, named_reaching=0))["targets"]["paper"]["no_reach"]
    assert still["target_named_while_moving"] is None


def test_calibration_is_pooled_over_trials():
    def sums(n, stated, right, brier):
        zeros = [0] * 8
        return {
            "calibration_n": [*zeros, *n], "calibration_stated": [*zeros, *stated],
            "calibration_right": [*zeros, *right], "brier_sum": brier, "brier_n": sum(n),
        }  # fmt: skip

    rows = [
        reach("a", **sums([2, 1], [1.7, 0.95], [1.0, 1.0], 0.5)),
        reach("b", valid=False, **sums([0, 3], [0.0, 2.85], [0.0, 3.0], 0.1)),
        reach("c"),
    ]
    calibration = summary_of(*rows)["targets"]["paper"]["calibration"]
    assert calibration == {
        "ece": pytest.approx((0.7 + 0.2) / 6), "brier": pytest.approx(0.1), "answers": 6,
        "bins": [
            {"stated": pytest.approx(0.85), "right": 0.5, "answers": 2},
            {"stated": pytest.approx(0.95), "right": 1.0, "answers": 4},
        ],
    }  # fmt: skip
    assert summary_of(reach(calibration_n=None))["targets"]["paper"]["calibration"] is None


def test_commitments_of_all_and_of_valid_trials():
    early, late = {"commit_part": [0.2] * 12, "commit_right": [True] * 12}, {
        "commit_part": [0.8] * 12, "commit_right": [False] * 12,
    }  # fmt: skip
    rows = [reach("a", group="near", **early), reach("b", valid=False, group="far", **late)]
    curves = summary_of(*rows, no_reach(seconds=60.0))["targets"]["paper"]["commitment"]
    means = {name: curve[0]["mean_part"] for name, curve in curves.items()}
    assert means == {"all": 0.5, "valid": 0.2, "group far": 0.8, "group near": 0.2}
    assert {curve[0]["false_per_minute"] for curve in curves.values()} == {1.0}


def test_a_frame_has_every_column():
    frame = frame_of([{"recording": "a", "targets": "paper", "problem": "is gone"}])
    assert set(frame) >= {"participant", "target", "valid", "success", "seconds", "remark"}
    assert frame["participant"].tolist() == ["unknown"]
    assert frame["success"].isna().all()
    rows = frame_of([reach("a"), reach("b", problem="x"), reach("c", valid=None), no_reach()])
    assert reaches_of(rows)["recording"].tolist() == ["a", "c"]
    assert valid_of(reaches_of(rows))["recording"].tolist() == ["a"]
    assert isinstance(rows, pd.DataFrame)


def test_times_and_first_commitments_of_each_set():
    """The times are those of the sets; the first commitments are at the default reliability."""
    k = RELIABILITIES.index(CommitmentConfig().reliability)

    def timed(error, committed, **more):
        part = [0.9] * len(RELIABILITIES)
        part[k] = committed
        held = None if error is None else abs(error) < 0.05
        times = {"contact_asked_at_60%": True, "contact_error_at_60%": error,
                 "contact_held_at_60%": held}  # fmt: skip
        right = [row is not None for row in part]
        return reach(**times, commit_part=part, commit_right=right, **more)

    paper = summary_of(
        timed(0.03, 0.4, group="near"), timed(-0.07, None, group="far", valid=False),
        timed(None, 0.6, group="far"), no_reach(seconds=30.0, commits=list(range(12))),
    )["targets"]["paper"]  # fmt: skip
    everywhere = paper["times"]["all"]["contact"]["60%"]
    assert (everywhere["asked"], everywhere["held"]) == (3, 0.5)
    assert everywhere["given"] == pytest.approx(2 / 3)
    assert everywhere["median_s"] == pytest.approx(0.05)
    assert everywhere["bias_s"] == pytest.approx(-0.02)
    assert paper["times"]["valid"]["contact"]["60%"]["median_s"] == pytest.approx(0.03)
    assert paper["times"]["group far"]["contact"]["60%"]["bias_s"] == pytest.approx(-0.07)
    assert paper["times"]["all"]["end"] == {}
    first = paper["first_commitments"]
    assert set(first) == {"all", "valid", "group far", "group near"}
    assert first["all"]["committed"] == pytest.approx(2 / 3)
    assert first["all"]["mean_part"] == pytest.approx((0.4 + 0.6 + 1.0) / 3)
    assert first["valid"]["committed"] == 1.0
    assert first["all"]["false_per_minute"] == 2 * k
    assert first["all"]["reliability"] == CommitmentConfig().reliability
