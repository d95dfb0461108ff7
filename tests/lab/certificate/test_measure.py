"""The numbers of a certificate, from runs whose latencies are known."""

from __future__ import annotations

import json
import random
import subprocess
import sys

import numpy as np
import pytest

from browser import CHROMIUM, accessibility_problems, open_page
from igrip.errors import IgripError
from igrip.lab.certificate.measure import FAULTS, Limits, Stop, latencies, verdict
from igrip.lab.certificate.page import page


def run(delays, travel=0.002, period=1 / 30):
    """Observations, each answered after its delay; None: never."""
    sent = [(100.0 + k * period, True) for k in range(len(delays))]
    received = []
    for (left, _), delay in zip(sent, delays, strict=True):
        if delay is not None:
            came = left + delay
            age = delay - 2 * travel
            received.append((came, {"sent": came - travel, "age": age}))
    return sent, received


def test_latencies_are_those_of_the_run():
    random.seed(1)
    delays = [random.uniform(0.005, 0.09) for _ in range(3000)]
    found = latencies(*run(delays), deadline=80.0)
    expected = np.array(delays) * 1000.0
    assert found["p50"] == pytest.approx(np.median(expected), abs=0.1)
    assert found["p99"] == pytest.approx(np.quantile(expected, 0.99), abs=0.5)
    assert found["max"] == pytest.approx(expected.max())
    assert found["jitter"] == pytest.approx(expected.std())
    assert found["missed"] == pytest.approx(np.mean(expected > 80.0))


def test_an_observation_without_an_intention_is_a_missed_deadline():
    found = latencies(*run([0.01, None, 0.01, 0.01]), deadline=50.0)
    assert found["missed"] == 0.25
    with pytest.raises(IgripError, match="too few"):
        latencies(*run([0.01, None]), deadline=50.0)


def test_the_verdict_names_what_is_beyond_a_limit():
    good = {"p99": 20.0, "missed": 0.0}
    stops = [Stop(name, meaning, [100.0, 120.0]) for name, meaning in FAULTS.items()]
    assert verdict(good, stops, Limits()) == []
    stops[0].times.append(300.0)
    stops[1].never = 1
    found = verdict({"p99": 200.0, "missed": 0.5}, stops, Limits())
    assert [text.partition(":")[0] for text in found] == [
        "latency", "missed deadlines", stops[0].fault, stops[1].fault
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_certificate_of_this_machine(tmp_path):
    file = tmp_path / "serial.toml"
    file.write_text("ramp = 0.1\n")
    done = subprocess.run(
        [sys.executable, "-m", "igrip", "certify", "--device", "serial", "--config", file,
         "--out", tmp_path / "out", "--seconds", "10", "--repeats", "1", "--limit-latency", "60000",
         "--limit-stop", "60000", "--limit-missed", "1"], capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "out" / "certificate.json").read_text())
    assert [one["fault"] for one in found["stops"]] == list(FAULTS)
    assert all(one["never"] == 0 for one in found["stops"])
    html = (tmp_path / "out" / "certificate.html").read_text()
    assert html == page(found)
    if CHROMIUM:
        with open_page((tmp_path / "out" / "certificate.html").as_uri()) as shown:
            assert accessibility_problems(shown) == []
    assert "no medical" in html
    assert f"{found['latency']['p99']:.1f} ms" in html
