"""Damaged files of every kind: an error that names the file or a result, and nothing half done."""

from __future__ import annotations

import gzip
import json
import random
import re
import shutil
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import trimesh

import mocap_files as mocap
import plain_tables as plain
from datasets import write_small_dataset
from igrip import load_objects
from igrip.errors import IgripError
from igrip.io.column_map import read_column_map
from igrip.io.datasets.check import check_trial
from igrip.io.datasets.dataset import Dataset
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import ImportFiles
from igrip.io.importers.motion_capture import MotionCapture
from igrip.io.inspection import inspect_files, map_from
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.resampling import ImportOptions
from igrip.io.takes.declared import Declared
from mocap_files import Body, Scene

MANY, FEW = 100_000, 1_000
CONSTANT = 24 * 2**20  # bytes beside four times the file: what the first use of a library takes
JUNK = [b"", b",", b";", b"\t", b"\n", b"\r", b"\0", b'"', b"nan", b"1e999", b"-9999", b"9" * 40,
        b"\xff\xfe", b"\xef\xbb\xbf", b"Frame", b"Position", b"X", b"Trajectories\n", b",,,,,,",
        b"\xc3\xa9", b"-", b".", b"1e300", b"[", b"]", b"=", b"{}", b"\x1f\x8b"]  # fmt: skip


def scene() -> Scene:
    table = plain.samples(50.0)
    turned = np.tile([0.0, 0.0, 0.0, 1.0], (len(table), 1))
    mug = np.tile([-0.1, 0.4, 0.06], (len(table), 1))
    bodies = {"Right Hand": Body(table[:, 1:] / 1000, turned), "mug": Body(mug, turned)}
    return Scene(table[:, 0], bodies, 50.0)


def compressed(folder: Path) -> None:
    path = plain.write(folder, plain.lines(plain.samples(50.0))) / "take1.csv"
    (folder / "take1.csv.gz").write_bytes(gzip.compress(path.read_bytes()))
    path.unlink()


def long_format(folder: Path) -> Path:
    rows = [
        f"{t:.3f},{name},{x:.5f},{y:.5f},{z:.5f}"
        for k, t in enumerate(scene().times)
        for name, body in scene().bodies.items()
        for x, y, z in [body.positions[k]]
    ]
    return plain.write(folder, ["time,body,x,y,z", *rows])


# what is written, and whether a map goes with it
TABLES = {
    "motive": lambda d: mocap.motive(d / "take1.csv", scene()),
    "qtm 3D": lambda d: mocap.qtm_3d(d / "take1.tsv", scene()),
    "qtm 6D": lambda d: mocap.qtm_6d(d / "take1.tsv", scene()),
    "vicon": lambda d: mocap.vicon(d / "take1.csv", scene()),
    "vicon segments": lambda d: mocap.vicon(d / "take1.csv", scene(), section="Segments"),
    "trc": lambda d: mocap.trc(d / "take1.trc", scene()),
    "c3d": lambda d: mocap.c3d(d / "take1.c3d", scene()),
    "motion-bids": lambda d: mocap.motion_bids(d, scene()),
    "plain": lambda d: plain.write(d, plain.lines(plain.samples(50.0))),
    "decimal commas": lambda d: plain.write(d, plain.lines(plain.samples(50.0), ";", ",")),
    "utf-16": lambda d: plain.write(d, plain.lines(plain.samples(50.0)), encoding="utf-16"),
    "compressed": compressed,
    "long format": long_format,
}


def damaged(rng: random.Random, data: bytes) -> bytes:
    """Return bytes with a few places changed, cut out, doubled, or put in."""
    for _ in range(rng.choice((1, 1, 2, 5, 20))):
        # headers are short, and what they say matters most
        reach = len(data) if rng.random() < 0.4 else min(len(data), 600)
        at = rng.randrange(reach + 1)
        length = rng.choice((1, 1, 2, 8, 60, 1000))
        kind = rng.randrange(6)
        if kind == 0:
            data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
        elif kind == 1:
            data = data[:at] + data[at + length :]
        elif kind == 2:
            data = data[:at] + data[at : at + length] + data[at:]
        elif kind == 3:
            data = data[:at] + rng.choice(JUNK) + data[at:]
        elif kind == 4:
            data = data[:at] + rng.choice(JUNK) + data[at + length :]
        else:
            data = data[:at] if rng.random() < 0.3 else data[at:] + data[:at]
    return data


def bring(folder: Path, out: Path, catalog) -> None:
    """Inspect and import a folder as the command does."""
    with suppress(IgripError):
        map_from(inspect_files([folder], Declared()))
    files = ImportFiles([folder])
    if (folder / "map.toml").is_file():
        importer = ColumnMapImporter(read_column_map(folder / "map.toml"))
    else:
        importer = MotionCapture()
    import_dataset(
        importer, importer.reaches(files), out, catalog, ImportOptions(), ["ycb"], problems=[]
    )


def farthest(folder: Path) -> float:
    """Return the largest coordinate in a dataset [m]; 0 where there is none."""
    if not folder.exists():
        return 0.0
    dataset = Dataset.open(folder)
    entities = (
        entity
        for trial in dataset.trials
        for message in dataset.observations(trial)
        for entity in (*message.hands.values(), *message.objects.values())
        if entity is not None
    )
    return max((max(map(abs, entity.position)) for entity in entities), default=0.0)


def check(folder: Path, catalog) -> None:
    dataset = Dataset.open(folder, lenient=True)
    dataset.participants_without_trials()
    for trial in dataset.trials:
        check_trial(dataset, trial, catalog)


def use_damaged(good: Path, work: Path, seed: str, rounds: int, use) -> int:
    """Use copies of a folder, each with one damaged file; bound the memory that this takes.

    Return how many could be used all the same.
    """
    files = [path for path in sorted(good.rglob("*")) if path.is_file()]
    rng = random.Random(seed)
    used = 0
    tracemalloc.start()
    try:
        for _ in range(rounds):
            shutil.copytree(good, work)
            victim = rng.choice(files)
            data = damaged(rng, victim.read_bytes())
            (work / victim.relative_to(good)).write_bytes(data)
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            with suppress(IgripError):
                use(work)
                used += 1
            assert tracemalloc.get_traced_memory()[1] - before < 4 * len(data) + CONSTANT
            shutil.rmtree(work)
    finally:
        tracemalloc.stop()
    return used


@pytest.fixture(scope="module")
def catalog():
    return load_objects("ycb")


def count(few: int) -> list:
    return [few, pytest.param(few * MANY // FEW, marks=[pytest.mark.slow, pytest.mark.timeout(0)])]


@pytest.mark.parametrize("rounds", count(60))
@pytest.mark.parametrize("kind", TABLES)
def test_tables(tmp_path, catalog, kind, rounds):
    good = tmp_path / "good"
    good.mkdir()
    TABLES[kind](good)
    bring(good, tmp_path / "first", catalog)  # loads the models and the libraries
    files = [path for path in sorted(good.rglob("*")) if path.is_file()]
    rng = random.Random(f"{kind} {rounds}")
    work, out = tmp_path / "work", tmp_path / "out"
    tracemalloc.start()
    try:
        for _ in range(rounds):
            shutil.copytree(good, work)
            victim = rng.choice(files)
            data = damaged(rng, victim.read_bytes())
            (work / victim.relative_to(good)).write_bytes(data)
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            with suppress(IgripError):
                bring(work, out, catalog)
            # whole or not at all
            assert not out.exists() or Dataset.open(out).trials
            peak = tracemalloc.get_traced_memory()[1] - before
            assert peak < 4 * len(data) + CONSTANT
            assert {path.name for path in tmp_path.iterdir()} <= {"good", "first", "work", "out"}
            shutil.rmtree(work)
            shutil.rmtree(out, ignore_errors=True)
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("huge", ["-1.7e308", "1e160", "3e29"])
@pytest.mark.parametrize("kind", ["motive", "qtm 6D", "vicon segments", "trc", "plain"])
def test_numbers_whose_squares_overflow(tmp_path, catalog, kind, huge):
    good = tmp_path / "good"
    good.mkdir()
    TABLES[kind](good)
    rng = random.Random(f"{kind} {huge}")
    [path] = [path for path in good.iterdir() if path.stem == "take1"]
    text = path.read_text()
    numbers = list(re.finditer(r"-?\d+\.\d+(e-?\d+)?", text))
    for one in [*rng.sample(numbers, 4), *rng.sample(numbers[-40:], 4)]:
        path.write_text(text[: one.start()] + huge + text[one.end() :])
        with suppress(IgripError):
            bring(good, tmp_path / "out", catalog)
        assert farthest(tmp_path / "out") < 100.0
        shutil.rmtree(tmp_path / "out", ignore_errors=True)


@pytest.mark.parametrize("rounds", count(120))
def test_datasets(tmp_path, rounds):
    good = write_small_dataset(tmp_path / "good").path
    models = load_objects(*Dataset.open(good).objects)
    check(good, models)  # loads the libraries
    use_damaged(good, tmp_path / "work", f"dataset {rounds}", rounds, lambda d: check(d, models))


@pytest.mark.filterwarnings("ignore")  # of the meshes' readers
@pytest.mark.parametrize("rounds", count(160))
def test_meshes(tmp_path, rounds, monkeypatch):
    monkeypatch.setenv("IGRIP_CACHE_DIR", str(tmp_path / "cache"))
    good = tmp_path / "good"
    good.mkdir()
    for ending in ("stl", "ply", "obj", "glb", "off"):
        trimesh.creation.box((0.05, 0.08, 0.2)).export(good / f"box_{ending}.{ending}")
    trimesh.creation.box((50.0, 80.0, 200.0)).export(good / "obj_000001.ply")
    (good / "models_info.json").write_text(
        json.dumps({"1": {"symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}})
    )
    (good / "objects.toml").write_text('[defaults]\nsymmetry = "box"\n[box_stl]\nunit = "m"\n')
    load_objects(good)
    # a mesh that cannot be read is left out; the others can be used
    assert use_damaged(good, tmp_path / "work", f"mesh {rounds}", rounds, load_objects) > 0


def test_a_large_table_takes_four_times_its_size_at_most(tmp_path, catalog):
    table = plain.samples(1000.0, 60.0)
    folder = plain.write(tmp_path / "in", plain.lines(table))
    size = (folder / "take1.csv").stat().st_size
    bring(
        plain.write(tmp_path / "small", plain.lines(plain.samples())), tmp_path / "first", catalog
    )
    tracemalloc.start()
    try:
        bring(folder, tmp_path / "out", catalog)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 4 * size + CONSTANT


def test_a_small_file_that_becomes_huge_is_refused(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "take1.csv.gz").write_bytes(gzip.compress(b"0" * 200_000_000))
    tracemalloc.start()
    try:
        [found] = inspect_files([folder], Declared())
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert "times larger when decompressed" in found.problem
    assert peak < 64 * 2**20
