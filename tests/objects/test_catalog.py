"""Catalogues: names, pickling, and what is kept on disk."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from igrip import Catalog, IgripError, load_objects
from igrip.compiled import cache_directory
from igrip.errors import ObjectsError, UnknownModelError
from igrip.objects import catalog as module
from support import BOX, CAN, PAPER

ARRAYS = ("vertices", "faces", "centre", "mesh_from_object", "sphere")


def assert_same(a, b):
    for name in ARRAYS:
        ours, theirs = getattr(a, name), getattr(b, name)
        assert ours.dtype == theirs.dtype
        assert ours.tobytes() == theirs.tobytes(), name
    for ours, theirs in zip((*a.bvh, *a.vertex_tree), (*b.bvh, *b.vertex_tree), strict=True):
        assert ours.dtype == theirs.dtype
        assert ours.tobytes() == theirs.tobytes()
    assert (a.name, a.symmetry, a.length, a.radius) == (b.name, b.symmetry, b.length, b.radius)


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty directory in place of the user's cache."""
    monkeypatch.setattr(module, "cache_directory", lambda: tmp_path / "cache")
    return tmp_path / "cache" / "models"


@pytest.fixture
def builds(monkeypatch):
    """The names of the models that were built, not read."""
    built, build = [], module.build_model

    def counting(name, *rest):
        built.append(name)
        return build(name, *rest)

    monkeypatch.setattr(module, "build_model", counting)
    return built


def test_it_is_a_mapping(ycb):
    assert len(ycb) == 78
    assert list(ycb) == sorted(ycb)
    assert set(PAPER) <= set(ycb)
    assert ycb["006_mustard_bottle"] is ycb["006_mustard_bottle"]
    assert ycb.get("no such thing") is None
    assert "006_mustard_bottle" in ycb
    assert "mustard" not in ycb
    assert "78" in repr(ycb)


@pytest.mark.parametrize("name", ["mustard", "", None, 3, "x" * 10_000])
def test_unknown_models(ycb, name):
    with pytest.raises(UnknownModelError) as raised:
        ycb[name]
    assert isinstance(raised.value, IgripError)
    assert isinstance(raised.value, KeyError)
    assert str(raised.value).startswith("the catalogue has no model")
    assert len(str(raised.value)) < 150


def test_nothing_is_read_before_it_is_asked_for(cache, builds):
    catalog = load_objects("ycb", BOX)
    assert builds == []
    assert not cache.exists()
    catalog[BOX]
    assert builds == [BOX]


def test_a_folder_is_read_at_once(tmp_path, cache, builds):
    folder = tmp_path / "meshes"
    folder.mkdir()
    trimesh.creation.box((0.1, 0.1, 0.2)).export(folder / "thing.ply")
    load_objects(folder)
    assert builds == ["thing"]


def test_the_cache_gives_the_same_bits(cache, builds):
    first = load_objects(CAN)[CAN]
    second = load_objects(CAN)[CAN]
    assert builds == [CAN]
    assert second is not first
    assert_same(first, second)
    assert len(list(cache.iterdir())) == 1


@pytest.mark.parametrize("part", [0.0, 0.001, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_a_cache_that_was_cut_is_built_again(cache, builds, part):
    first = load_objects(CAN)[CAN]
    [path] = cache.iterdir()
    whole = path.read_bytes()
    path.write_bytes(whole[: int(part * len(whole))])
    assert_same(first, load_objects(CAN)[CAN])
    assert builds == [CAN, CAN]
    assert path.read_bytes() == whole
    load_objects(CAN)[CAN]
    assert builds == [CAN, CAN]


def test_a_cache_with_wrong_bytes_is_built_again(cache, builds):
    first = load_objects(CAN)[CAN]
    [path] = cache.iterdir()
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    for at in [*range(0, 400, 7), *rng.integers(0, len(whole), 60)]:
        damaged = bytearray(whole)
        damaged[at] ^= 0xFF
        path.write_bytes(bytes(damaged))
        assert_same(first, load_objects(CAN)[CAN])


def test_no_half_written_file_is_left(cache):
    load_objects(CAN, BOX)[CAN]
    assert [path.suffix for path in cache.iterdir()] == [".npz"]


def test_a_cache_that_cannot_be_written_is_only_slow(tmp_path, monkeypatch, builds):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setattr(module, "cache_directory", lambda: blocked)
    for _ in range(2):
        assert load_objects(CAN)[CAN].length == pytest.approx(0.10)
    assert builds == [CAN, CAN]


def test_an_edited_mesh_or_table_is_built_again(tmp_path, cache, builds):
    folder = tmp_path / "meshes"
    folder.mkdir()
    for count, (size, table) in enumerate(
        [
            (0.2, ""),
            (0.25, ""),
            (0.25, '[thing]\nsymmetry = "box"'),
            (0.25, "[thing]\naxis=[1,0,0]"),
        ]
    ):
        trimesh.creation.box((0.1, 0.1, size)).export(folder / "thing.ply")
        (folder / "objects.toml").write_text(table)
        model = load_objects(folder)["thing"]
        assert len(builds) == count + 1
        assert model.length == pytest.approx(0.1 if "axis" in table else size)
    assert model.symmetry == "none"


@pytest.mark.parametrize("sources", [("ycb",), (BOX, CAN)])
def test_pickling(sources):
    catalog = load_objects(*sources)
    again = pickle.loads(pickle.dumps(catalog))
    assert isinstance(again, Catalog)
    assert list(again) == list(catalog)
    name = "005_tomato_soup_can" if "ycb" in sources else CAN
    assert_same(again[name], catalog[name])
    assert len(pickle.dumps(catalog)) < 1000


def test_pickling_a_folder(tmp_path):
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "thing.ply")
    (tmp_path / "objects.toml").write_text('[thing]\nalias = ["that"]')
    catalog = pickle.loads(pickle.dumps(load_objects(tmp_path)))
    assert catalog["that"].name == "thing"


def test_sources_as_paths_and_as_text(tmp_path):
    trimesh.creation.box((0.1, 0.1, 0.2)).export(tmp_path / "thing.ply")
    assert_same(load_objects(tmp_path)["thing"], load_objects(str(tmp_path))["thing"])


def test_a_model_that_cannot_be_used_is_an_error_each_time(tmp_path):
    (tmp_path / "bad.obj").write_bytes(b"v 0 0 0\nv 0.1 0 0\nv 0.2 0 0\nf 1 2 3\n")
    catalog = Catalog(tmp_path)
    for _ in range(2):
        with pytest.raises(ObjectsError):
            catalog["bad"]


PROBE = """
import json, sys
from igrip.compiled import cache_directory, kernel_cache_directory
from igrip import load_objects
model = load_objects("box:0.1x0.1x0.2")["box:0.1x0.1x0.2"]
print(json.dumps({"cache": str(cache_directory()), "kernel": str(kernel_cache_directory()),
                  "length": model.length}))
"""


def fresh_process(**environment):
    done = subprocess.run(
        [sys.executable, "-c", PROBE],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return json.loads(done.stdout)


def test_the_directory_of_the_cache_can_be_chosen(tmp_path):
    # the compiled kernels are linked in, so that the fresh process need not compile them
    chosen = tmp_path / "chosen"
    chosen.mkdir()
    (chosen / "kernel").symlink_to(cache_directory() / "kernel")
    told = fresh_process(IGRIP_CACHE_DIR=str(chosen))
    assert told["cache"] == str(chosen)
    assert told["kernel"].startswith(str(chosen / "kernel"))
    assert told["length"] == pytest.approx(0.2)
    [model] = (chosen / "models").iterdir()
    model.write_bytes(model.read_bytes()[:100])  # as after a crash
    assert fresh_process(IGRIP_CACHE_DIR=str(chosen))["length"] == pytest.approx(0.2)
    assert model.stat().st_size > 1000


def test_a_cache_directory_that_cannot_be_used(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    code = "from igrip.compiled import cache_directory as c; print(c()); print(c().is_dir())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "IGRIP_CACHE_DIR": str(blocked / "below")},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    path, usable = done.stdout.split()
    assert usable == "True"
    assert not path.startswith(str(tmp_path))
