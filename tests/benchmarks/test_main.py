"""``python -m benchmarks`` as a developer types it."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_a_short_run_measures_everything(tmp_path):
    pytest.importorskip("embreex", reason="no wheel for this machine")
    picture = tmp_path / "bench.svg"
    options = ["--frames=20", "--runs=1", "--plain-frames=1", "--cadence=1", "--memory-frames=100"]
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks", *options, "--plot", picture, "--json"],
        cwd=ROOT, capture_output=True, text=True, timeout=240,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert set(report["peers"]["best"]) == {
        "igrip, update", "igrip, update with bayes", "igrip, update with distances to surfaces",
        "embreex, rays alone", "embreex, whether rays hit", "embreex + numpy + scipy, frame",
    }  # fmt: skip
    assert report["peers"]["plain_trimesh"]["p50_ms"] > 0
    assert [row["case"] for row in report["growth"]["objects"]] == [1, 4, 20, 100]
    assert [row["case"] for row in report["growth"]["rays"]] == [12, 36, 108]
    assert [row["case"] for row in report["growth"]["faces"]] == [320, 1280, 5120, 20480]
    assert report["memory"]["frames"] == 100
    assert len(report["bars"]) == 8
    assert picture.read_text(encoding="utf-8").startswith("<?xml")
