"""A second training gives what ships. It takes a quarter of an hour on two cores."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from datasets import shared_folder


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_training_anew_gives_the_same_predictions():
    folder = shared_folder()
    if folder is None or not (folder / "wispinski2021").exists():
        pytest.skip("the shared data is not beside the checkout")
    done = subprocess.run(
        [sys.executable, "-m", "training", str(folder), "--check"],
        capture_output=True, text=True, cwd=Path(__file__).parents[2], check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr[-2000:]
