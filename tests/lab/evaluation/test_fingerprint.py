"""Everything that an evaluation's rows depend on changes the fingerprint."""

import shutil

import pytest
import trimesh

from igrip import Config
from igrip.io.datasets.dataset import Dataset
from igrip.lab.evaluation import fingerprint as module
from igrip.lab.evaluation.fingerprint import fingerprint
from igrip.objects import mesh_folder

CONFIGS = (Config(targets="paper"),)


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Let the code and the weights be a few files that a test may change."""
    folder = tmp_path / "package"
    (folder / "targets").mkdir(parents=True)
    (folder / "code.py").write_text("a = 1")
    (folder / "targets" / "weights.json").write_text("[1]")
    monkeypatch.setattr(module, "PACKAGE", folder)
    return folder


@pytest.fixture
def meshes(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    trimesh.creation.box((0.05, 0.05, 0.1)).export(folder / "a.stl")
    (folder / "objects.toml").write_text('[a]\nalias = ["b"]\n')
    return folder


def test_the_package_is_the_whole_of_igrip():
    assert (module.PACKAGE / "estimator.py").is_file()
    assert (module.PACKAGE / "targets" / "learned" / "bayes.json").is_file()


def test_it_repeats(small_dataset, package):
    first = fingerprint(small_dataset, CONFIGS, ("ycb",))
    assert fingerprint(Dataset.open(small_dataset.path), CONFIGS, ("ycb",)) == first
    assert len(first) == 16


def test_configurations_and_sources(small_dataset, package):
    keys = {
        fingerprint(small_dataset, configs, objects)
        for configs in (CONFIGS, (Config(targets="distance"),), (*CONFIGS, Config()),
                        (Config(targets="paper", grips="cylinder"),))
        for objects in ((), ("box:0.1x0.1x0.1",), ("box:0.1x0.1x0.2",))
    }  # fmt: skip
    assert len(keys) == 12
    near = [("box:0.1x0.1x0.1", "box:0.1x0.1x0.2"), ("box:0.1x0.1x0.2", "box:0.1x0.1x0.1")]
    assert len({fingerprint(small_dataset, CONFIGS, objects) for objects in near}) == 2


@pytest.mark.parametrize("name", ["trials.tsv", "dataset.json"])
def test_tables(small_dataset, package, name):
    before = fingerprint(small_dataset, CONFIGS, ())
    with (small_dataset.path / name).open("a") as file:
        file.write("\n")
    assert fingerprint(small_dataset, CONFIGS, ()) != before


@pytest.mark.parametrize("name", ["code.py", "targets/weights.json"])
def test_code_and_weights(small_dataset, package, name):
    before = fingerprint(small_dataset, CONFIGS, ())
    (package / name).write_text("[2]")
    changed = fingerprint(small_dataset, CONFIGS, ())
    assert changed != before
    (package / name).unlink()
    assert fingerprint(small_dataset, CONFIGS, ()) not in (before, changed)


def test_a_mesh_and_what_is_declared_of_it(small_dataset, package, meshes):
    sources = (str(meshes),)
    keys = [fingerprint(small_dataset, CONFIGS, sources)]
    trimesh.creation.box((0.05, 0.05, 0.2)).export(meshes / "a.stl")
    keys.append(fingerprint(small_dataset, CONFIGS, sources))
    (meshes / "objects.toml").write_text('[a]\nsymmetry = "box"\n')
    keys.append(fingerprint(small_dataset, CONFIGS, sources))
    shutil.copy(meshes / "a.stl", meshes / "c.stl")
    keys.append(fingerprint(small_dataset, CONFIGS, sources))
    (meshes / "c.stl").rename(meshes / "d.stl")
    keys.append(fingerprint(small_dataset, CONFIGS, sources))
    assert len(set(keys)) == 5


def test_the_meshes_of_the_ycb_set(small_dataset, package, meshes, monkeypatch):
    meshes_of_set = mesh_folder.folder_meshes(meshes)
    monkeypatch.setattr(module, "ycb_meshes", lambda: meshes_of_set)
    before = fingerprint(small_dataset, CONFIGS, ("ycb",))
    trimesh.creation.box((0.05, 0.05, 0.2)).export(meshes / "a.stl")
    assert fingerprint(small_dataset, CONFIGS, ("ycb",)) != before


def test_the_version(small_dataset, package, monkeypatch):
    before = fingerprint(small_dataset, CONFIGS, ())
    monkeypatch.setattr(module, "__version__", "999")
    assert fingerprint(small_dataset, CONFIGS, ()) != before


def test_stamp_of_a_recording(small_dataset):
    first, second = small_dataset.trials
    before = small_dataset.stamp(first)
    assert before == small_dataset.stamp(first)
    path = small_dataset.recording(first)
    path.write_bytes(path.read_bytes()[:-1])
    assert small_dataset.stamp(first) not in (before, None)
    path.unlink()
    assert small_dataset.stamp(first) is None
    assert small_dataset.stamp(second) is not None
