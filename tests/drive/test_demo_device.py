"""``igrip demo --device``: each twin acts on what the estimator predicts."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

FILES = {
    "serial": "ramp = 0.1\n",
    "rehastim2": "limit_ma = 10\n[grips.palmar]\ngrasp = [{number = 1, current_ma = 9}]\n"
    "[grips.pinch]\ngrasp = [{number = 2, current_ma = 8}]\n",
    "p24": "limit_ma = 10\n[grips.palmar]\ngrasp = [{number = 1, current_ma = 9}]\n"
    "[grips.pinch]\ngrasp = [{number = 2, current_ma = 8}]\n",
    "ability-hand": "[grips.palmar]\nreach = [20, 20, 20, 20, 20, -80]\n"
    "grasp = [90, 90, 90, 90, 60, -80]\n[grips.pinch]\nreach = [20, 20, 20, 20, 20, -60]\n"
    "grasp = [70, 10, 10, 10, 50, -60]\n",
    "nml-hand-exo": "[grips.palmar]\nreach = [0, 0, 0, 0, 0]\ngrasp = [40, 60, 60, 60, 60]\n"
    "[grips.pinch]\nreach = [0, 0, 0, 0, 0]\ngrasp = [40, 60, 0, 0, 0]\n",
    "dynamixel": "motors = [1, 2]\nrest = [10, 10]\n[grips.palmar]\nreach = [10, 20]\n"
    "grasp = [60, 70]\n[grips.pinch]\nreach = [10, 20]\ngrasp = [60, 20]\n",
}
PACKAGES = {
    "serial": "serial", "rehastim2": "pysciencemode", "p24": "science_mode_4",
    "ability-hand": "ah_wrapper", "nml-hand-exo": "nml_hand_exo", "dynamixel": "dynamixel_sdk",
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(FILES))
def test_the_twin_acts_in_the_demo(name, tmp_path):
    import importlib.util

    if importlib.util.find_spec(PACKAGES[name]) is None:
        pytest.skip(f"{PACKAGES[name]} is not installed")
    file = tmp_path / "device.toml"
    file.write_text(FILES[name])
    done = subprocess.run(
        [sys.executable, "-m", "igrip", "demo", "--headless", "--duration", "25", "--device", name,
         "--device-config", file, "--twin", "--arm"], capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert re.search(r"grasp \w+ (palmar|pinch)", done.stderr), done.stderr
    assert "device closing" in done.stderr


def test_a_device_needs_its_file():
    done = subprocess.run(
        [sys.executable, "-m", "igrip", "demo", "--headless", "--device", "serial"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 2
    assert "--device-config" in done.stderr
