"""``igrip tune`` as a user types it, from a dataset to a configuration that the others read."""

import json
from html.parser import HTMLParser

import numpy as np
import pytest
from typer.testing import CliRunner

pytest.importorskip("optuna", reason="the extra 'tune' is not installed")


from browser import CHROMIUM, accessibility_problems, open_page
from datasets import MESH, PLACES
from igrip import Observation
from igrip.cli.app import app
from igrip.config import Config
from igrip.io.config_file import read_config
from igrip.io.datasets.dataset import Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.simulation.minimum_jerk import reach


def igrip(*arguments, code=0):
    """Run a command in this process: another one takes seconds to start."""
    done = CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)
    assert done.exit_code == code, done.output
    return done


class Page(HTMLParser):
    """Rows of each table by its id, and all links."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.links, self.pictures, self._rows = {}, [], 0, []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag == "table":
            self._rows = self.tables.setdefault(dict(attrs)["id"], [])
        elif tag == "tr":
            self._rows.append("")
        elif tag == "a":
            self.links.append(dict(attrs)["href"])
        elif tag == "img":
            self.pictures += dict(attrs)["src"].startswith("data:image/svg+xml;base64,")

    def handle_data(self, data):
        if self._rows:
            self._rows[-1] += data


@pytest.fixture
def eight(tmp_path):
    """Eight reaches of one person, and one of another."""
    random = np.random.default_rng(0)
    with DatasetWriter(tmp_path / "eight", "Eight", "MIT", "made", objects=[MESH]) as writer:
        for number in range(9):
            target = ("near", "far")[number % 2]
            parts = np.clip(np.arange(61) / 30 - 1.0, 0, 1)
            points = reach(np.zeros(3), PLACES[target] - [0.0, 0.08, 0.0], 0.03, parts)
            points = points + random.normal(0.0, 0.001, points.shape)
            objects = {
                id: {"model": MESH, "position": p.tolist(), "orientation": [0, 0, 0, 1],
                     "static": True}
                for id, p in PLACES.items()
            }  # fmt: skip
            messages = [
                Observation(t=k / 30, hands={"right": {"position": p.tolist()}},
                            objects=objects if k == 0 else {})
                for k, p in enumerate(points)
            ]  # fmt: skip
            trial = Trial(
                f"r{number}", "anna" if number < 8 else "bert", hand="right", target=target,
                onset_s=1.0, end_s=2.0,
            )  # fmt: skip
            writer.add(trial, messages)
        return writer.close()


def test_tune_writes_a_configuration_a_record_and_a_page(eight, tmp_path):
    out = tmp_path / "tuned"
    arguments = ("tune", eight.path, "--participant", "anna", "--out", out, "--trials", 13)
    record = json.loads(igrip(*arguments, "--json").stdout)
    assert record == json.loads((out / "tune.json").read_text(encoding="utf-8"))
    assert record["reaches"] == 8
    assert sorted(name for fold in record["folds"] for name in fold["recordings"]) == [
        f"r{k}" for k in range(8)
    ]
    config = read_config(out / "config.toml")
    assert config.commitment.reliability == record["values"]["commitment.reliability"]
    assert record["tuned"] or config == Config()
    page = Page((out / "tune.html").read_text(encoding="utf-8"))
    assert page.pictures == 1
    assert page.links == [f"front/{k + 1:02d}.toml" for k in range(len(record["front"]))]
    assert len(page.tables["front"]) == len(record["front"]) + 1
    for row, one, link in zip(page.tables["front"][1:], record["front"], page.links, strict=True):
        assert f"{100.0 * one['committed']:.1f} %" in row
        chosen = read_config(out / link).commitment
        assert chosen.max_dwell == one["values"]["commitment.max_dwell"]
    # what was done is not done again, and the result is the same
    again = json.loads(igrip(*arguments, "--json").stdout)
    assert again == record
    igrip("replay", eight.path, "--config", out / "front" / "01.toml")
    if CHROMIUM:
        with open_page((out / "tune.html").as_uri()) as shown:
            assert accessibility_problems(shown) == []


def test_wrong_input_is_one_clear_error(eight, tmp_path):
    out = tmp_path / "tuned"
    for name, words in (("bert", "at least 8 trials of bert, there are 1"),
                        ("ana", "did you mean 'anna'?")):  # fmt: skip
        done = igrip("tune", eight.path, "--participant", name, "--out", out, code=2)
        assert words in " ".join(done.stderr.split())
    assert not out.exists()
