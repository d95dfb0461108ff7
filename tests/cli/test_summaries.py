"""What ``igrip replay`` prints: tables, remarks and problems."""

import io

from rich.console import Console

from igrip.cli.summaries import print_dataset, print_recording, recording_summary
from igrip.intention import Intention


def printed(print_summary, summary):
    console = Console(file=io.StringIO(), width=160)
    print_summary(console, summary)
    return console.file.getvalue()


def answer(t, status="reaching", target=None, **more):
    return Intention(t=t, hand="right", status=status, target=target, **more)


def test_reaches_of_a_recording():
    intentions = [
        answer(0.0, "idle"), answer(0.1), answer(0.2, target="cup"), answer(0.3, "idle"),
        answer(0.4, target="cup"), answer(0.5, target="can"),
        answer(0.6, target="can", grip="pinch", confidence=0.75),
    ]  # fmt: skip
    summary = recording_summary("r.jsonl", "paper", 7, 0.6, intentions)
    hand = summary["hands"]["right"]
    assert hand["statuses"] == {"idle": 2, "reaching": 5}
    first, second = hand["reaches"]
    assert first == {
        "begin": 0.1, "end": 0.2, "target": "cup", "grip": None, "confidence": None,
        "same_target_since": 0.2,
    }  # fmt: skip
    assert (second["begin"], second["target"], second["same_target_since"]) == (0.4, "can", 0.5)
    text = printed(print_recording, summary)
    assert "r.jsonl: 7 messages, 0.6 s, 7 intentions by paper" in text
    assert "0.40-0.60 s" in text
    assert "0.75" in text
    idle = recording_summary("r.jsonl", "paper", 1, 0.0, intentions[:1])
    assert "no hand reached" in printed(print_recording, idle)


def test_a_dataset_with_remarks_and_problems():
    results = [
        {"targets": "paper", "group": "all", "trials": 2, "success": 0.5, "accuracy_40%": 0.25,
         "accuracy_60%": 1.0, "delay_s": -0.1, "delay_clipped_s": 0.0, "margin_s": None,
         "times": {"contact": {"60%": {"asked": 4, "given": 1.0, "median_s": 0.0444}}}},
        {"targets": "paper", "group": "near", "trials": 0},
    ]  # fmt: skip
    summary = {
        "dataset": "Set", "trials": 15, "participants": 2, "times_real_time": 99.6, "processes": 2,
        "derived": {"noise": 0.1, "from": [{"axes": ["x", "y"], "unit": "mm"}]},
        "results": results, "cut": [],
        "remarks": [{"recording": "a", "remark": "target 'cup' never appears"}],
        "problems": [
            {"recording": f"r{k}", "targets": "paper", "problem": "is gone"} for k in range(12)
        ],
    }  # fmt: skip
    text = printed(print_dataset, summary)
    assert "Set: 15 trials of 2 participants; 100 × real time on 2 process(es)" in text
    assert "noise: 0.1" in text
    assert "from: axes x y, unit mm\n" in text
    assert "a: target 'cup' never appears" in text
    assert "12 result(s) are missing" in text
    assert "r9 (paper): is gone" in text
    assert "r10 (paper)" not in text
    assert "… and 2 more" in text
    row = next(line for line in text.splitlines() if "50.0 %" in line)
    assert all(cell in row for cell in ("25.0 %", "100.0 %", "-0.10 s", "0.00 s", "44 ms"))
