"""A simulated cohort, exported as each system does, and imported again: the same evaluation."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import mocap_files
from igrip import Config, Observation, load_objects
from igrip.io.column_map import read_column_map
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.resampling import ImportOptions
from igrip.lab.evaluation.runner import run_trial
from igrip.lab.evaluation.trial_rows import score_run
from igrip.lab.simulation.minimum_jerk import reach
from mocap_files import Body, Scene

MESH = "cylinder:0.03x0.12"
RATE = 30.0
PLACES = {"near": np.array([0.1, 0.28, 0.06]), "far": np.array([-0.1, 0.48, 0.06])}
CONFIGS = [Config(targets=name) for name in ("paper", "bayes")]
NAMES = ("recording", "trial")  # of the files, which differ


def scenes() -> dict[str, tuple[str, str, Scene]]:
    """Return takes by name: the hand, the target, and what moves."""
    random = np.random.default_rng(7)
    found = {}
    for number in range(4):
        hand, other = ("right", "left") if number % 2 else ("left", "right")
        target = ("near", "far")[number // 2]
        place = PLACES[target]
        course = np.clip(np.arange(75) / RATE - 1.0, 0.0, 1.0)
        points = reach(np.zeros(3), place - [0.0, 0.08, 0.0], 0.03, course)
        points = points + random.normal(0, 0.0005, points.shape)
        points[20 + number : 24 + number] = np.nan  # lost while at rest
        turned = np.tile([0.0, 0.0, np.sin(0.2), np.cos(0.2)], (75, 1))
        still = random.normal(0, 0.0003, (75, 3)) + [0.3, 0.0, 0.02]
        bodies = {
            f"{hand.title()}Hand": Body(points, np.tile([0.0, 0.0, 0.0, 1.0], (75, 1))),
            f"{other.title()}Hand": Body(still, np.tile([0.0, 0.0, 0.0, 1.0], (75, 1))),
        }
        for id, where in PLACES.items():
            bodies[id] = Body(np.tile(where, (75, 1)), turned)
        found[f"take{number}"] = (hand, target, Scene(np.arange(75) / RATE, bodies, RATE))
    return found


def original(path: Path) -> Dataset:
    """Write the takes as they are, without any export."""
    writer = DatasetWriter(path, "Cohort", "MIT", "simulated", objects=[MESH])
    for name, (hand, target, scene) in scenes().items():
        messages = []
        for k, t in enumerate(scene.times):
            hands, objects = {}, {}
            for side in ("right", "left"):
                p = scene.bodies[f"{side.title()}Hand"].positions[k]
                hands[side] = {"position": p.tolist()} if np.isfinite(p).all() else None
            for id in PLACES:
                body = scene.bodies[id]
                objects[id] = {"model": MESH, "position": body.positions[k].tolist(),
                               "orientation": body.rotations[k].tolist()}  # fmt: skip
            messages.append(Observation(t=float(t), hands=hands, objects=objects))
        writer.add(Trial(name, "p1", name, hand=hand, target=target), messages)
    return writer.close()


MAP = """
name = "Cohort"
[samples]
table = "take*"
[trials]
table = "list"
[hands.right]
body = "RightHand"
[hands.left]
body = "LeftHand"
[objects.near]
body = "near"
model = "cylinder:0.03x0.12"
[objects.far]
body = "far"
model = "cylinder:0.03x0.12"
"""

# exports round to a micrometre: a hand that closes in at 5 cm/s then meets 8 cm 20 µs off
CONTACT = re.compile(r"contact_(s|error_at_.*)")
# of markers alone, the objects' rotation is not known: the cylinders are round
EXPORTS = {
    "motive": lambda d, n, s: mocap_files.motive(d / f"{n}.csv", s),
    "motive 1.25 in metres": lambda d, n, s: mocap_files.motive(
        d / f"{n}.csv", s, version="1.25", unit="Meters", parent=True),
    "motive, Euler angles": lambda d, n, s: mocap_files.motive(
        d / f"{n}.csv", s, rotation="Euler", euler="YXZ", unit="Centimeters"),
    "motive with decimal commas": lambda d, n, s: mocap_files.motive(
        d / f"{n}.csv", s, separator=";", decimal=","),
    "qtm 3D": lambda d, n, s: mocap_files.qtm_3d(d / f"{n}.tsv", s),
    "qtm 3D without names": lambda d, n, s: mocap_files.qtm_3d(
        d / f"{n}.tsv", s, names=False, version=True, decimal=","),
    "qtm 6D": lambda d, n, s: mocap_files.qtm_6d(d / f"{n}.tsv", s),
    "qtm 6D, names in the settings": lambda d, n, s: mocap_files.qtm_6d(
        d / f"{n}.tsv", s, prefixed=False, frames=False),
    "vicon trajectories": lambda d, n, s: mocap_files.vicon(d / f"{n}.csv", s),
    "vicon segments": lambda d, n, s: mocap_files.vicon(
        d / f"{n}.csv", s, section="Segments", blank=True, separator=";", decimal=","),
    "trc": lambda d, n, s: mocap_files.trc(d / f"{n}.trc", s),
    "trc in metres": lambda d, n, s: mocap_files.trc(d / f"{n}.tsv", s, unit="m", blank=False),
    "c3d": lambda d, n, s: mocap_files.c3d(d / f"{n}.c3d", s),
    "motion-bids": lambda d, n, s: mocap_files.motion_bids(d / "sub-01" / "motion", s, n),
}  # fmt: skip


def evaluated(dataset: Dataset) -> list[dict]:
    catalog = load_objects(MESH)
    rows = []
    for trial in dataset.trials:
        for row in score_run(run_trial(dataset, trial, catalog, CONFIGS)):
            rows.append({key: value for key, value in row.items() if key not in NAMES})
    return rows


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    return evaluated(original(tmp_path_factory.mktemp("cohort") / "original"))


@pytest.mark.parametrize("system", EXPORTS)
def test_the_same_evaluation(tmp_path, expected, system):
    folder = tmp_path / "export"
    folder.mkdir()
    lines = ["trial\tparticipant\thand\ttarget"]
    bids = system == "motion-bids"
    for name, (hand, target, scene) in scenes().items():
        EXPORTS[system](folder, name, scene)
        lines.append(f"{name}{'_motion' if bids else ''}\tp1\t{hand.title()}\t{target}")
    (folder / "list.tsv").write_text("\n".join(lines) + "\n")
    (tmp_path / "map.toml").write_text(MAP)
    importer = ColumnMapImporter(read_column_map(tmp_path / "map.toml"))
    dataset = import_dataset(
        importer, importer.reaches(ImportFiles([folder])), tmp_path / "out", load_objects(MESH),
        ImportOptions(mesh=MESH, rate=RATE), [MESH],
    )  # fmt: skip
    imported = evaluated(dataset)
    assert [row["problem"] for row in expected] == [None] * len(expected)
    assert len(imported) == len(expected)
    for ours, theirs in zip(imported, expected, strict=True):
        assert ours.keys() == theirs.keys()
        for key, value in theirs.items():
            if isinstance(value, list):
                assert [v is None for v in ours[key]] == [v is None for v in value], key
                numbers = [float(v) for v in value if v is not None]
                again = [float(v) for v in ours[key] if v is not None]
                assert again == pytest.approx(numbers, abs=1e-5), key
            elif isinstance(value, float):
                assert ours[key] == pytest.approx(
                    value, abs=1e-4 if CONTACT.fullmatch(key) else 1e-5
                ), key
            else:
                assert ours[key] == value, key
