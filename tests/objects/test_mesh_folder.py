"""Folders of meshes as they are downloaded."""

from __future__ import annotations

import json
import logging
import unicodedata

import numpy as np
import pytest
import trimesh

from igrip import load_objects
from igrip.errors import MeshUnitError, ObjectsError
from igrip.objects import mesh_folder
from igrip.objects.mesh_folder import folder_meshes

SIZE = np.array([0.05, 0.08, 0.2])


def box(path, scale=1.0, size=SIZE):
    path.parent.mkdir(parents=True, exist_ok=True)
    trimesh.creation.box(size * scale).export(path)
    return path


def names(folder):
    return {mesh.name: mesh.path.relative_to(folder).as_posix() for mesh in folder_meshes(folder)}


def test_the_layout_of_ycb(tmp_path):
    for name in ("003_cracker_box", "025_mug"):
        for variant in ("google_64k", "google_16k", "poisson", "tsdf"):
            for file in ("textured.obj", "nontextured.stl", "nontextured.ply"):
                box(tmp_path / name / variant / file)
        (tmp_path / name / "google_16k" / "kinbody.xml").write_text("<KinBody/>")
        (tmp_path / name / "clouds").mkdir()
        trimesh.PointCloud(np.eye(3)).export(tmp_path / name / "clouds" / "merged_cloud.ply")
    found = names(tmp_path)
    assert found["003_cracker_box"] == "003_cracker_box/google_16k/nontextured.ply"
    assert found["025_mug"] == "025_mug/google_16k/nontextured.ply"


def test_one_object_alone_is_named_after_its_folder(tmp_path):
    for file in ("textured.obj", "nontextured.stl"):
        box(tmp_path / "025_mug" / "google_16k" / file)
    assert list(names(tmp_path / "025_mug" / "google_16k")) == ["025_mug"]
    assert list(names(tmp_path / "025_mug")) == ["025_mug"]


def test_equal_names_in_two_folders_are_told_apart(tmp_path):
    box(tmp_path / "kitchen" / "cup.stl")
    box(tmp_path / "office" / "cup.stl")
    assert set(names(tmp_path)) == {"kitchen/cup", "office/cup"}


def test_visual_before_collision(tmp_path):
    box(tmp_path / "cup" / "collision" / "cup.stl")
    box(tmp_path / "cup" / "visual" / "cup.obj")
    assert names(tmp_path) == {"cup": "cup/visual/cup.obj"}


INFO = {
    "1": {"diameter": 172.0, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]},
    "2": {"diameter": 20.0,
          "symmetries_discrete": [np.diag([1.0, -1, -1, 1]).ravel().tolist(),
                                  np.diag([-1.0, 1, -1, 1]).ravel().tolist(),
                                  np.diag([-1.0, -1, 1, 1]).ravel().tolist()]},
    "12": {"diameter": 20.0, "symmetries_discrete": [np.diag([1.0, -1, -1, 1]).ravel().tolist()]},
}  # fmt: skip


def test_bop_is_in_millimetres_and_has_symmetries(tmp_path):
    for number in (1, 2, 12):
        box(tmp_path / "models" / f"obj_{number:06d}.ply", 1000.0)
        box(tmp_path / "models_eval" / f"obj_{number:06d}.ply", 1000.0)
    (tmp_path / "models" / "models_info.json").write_text(json.dumps(INFO))
    catalog = load_objects(tmp_path)
    assert list(catalog) == ["obj_000001", "obj_000002", "obj_000012"]
    assert [catalog[name].symmetry for name in catalog] == ["cylinder", "box", "none"]
    assert catalog["obj_000001"].axis == pytest.approx([0, 0, 1])
    assert catalog["obj_000002"].length == pytest.approx(0.2)
    assert all("models_eval" not in path for path in names(tmp_path).values())


@pytest.mark.parametrize("text", ["[1]", "{", '{"1": 3}', '{"1": {"symmetries_continuous": [3]}}'])
def test_a_damaged_models_info_is_named(tmp_path, text):
    box(tmp_path / "obj_000001.ply", 1000.0)
    (tmp_path / "models_info.json").write_text(text)
    with pytest.raises(ObjectsError, match=r"models_info\.json"):
        load_objects(tmp_path)


@pytest.mark.filterwarnings("ignore")  # the readers' own
def test_a_bad_file_costs_itself(tmp_path, caplog):
    box(tmp_path / "cup.stl")
    (tmp_path / "broken.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 900\n")
    trimesh.PointCloud(np.random.default_rng(0).normal(size=(50, 3))).export(tmp_path / "scan.ply")
    with caplog.at_level(logging.WARNING):
        assert list(load_objects(tmp_path)) == ["cup"]
    assert "broken.ply" in caplog.text
    assert "scan.ply: holds 50 points and no mesh with faces" in caplog.text


@pytest.mark.filterwarnings("ignore")
def test_a_bad_file_that_the_table_names_is_an_error(tmp_path):
    box(tmp_path / "cup.stl")
    (tmp_path / "broken.ply").write_bytes(b"ply\n")
    (tmp_path / "objects.toml").write_text('[broken]\nunit = "m"')
    with pytest.raises(ObjectsError, match=r"broken\.ply"):
        load_objects(tmp_path)


@pytest.mark.parametrize("form", ["NFC", "NFD"])
@pytest.mark.parametrize("asked", ["NFC", "NFD"])
def test_names_in_any_normal_form(tmp_path, form, asked):
    box(tmp_path / unicodedata.normalize(form, "Müsli.stl"))
    name = unicodedata.normalize(asked, "Müsli")
    (tmp_path / "objects.toml").write_text(f'["{name}"]\nsymmetry = "box"\nalias = ["Schüssel"]')
    catalog = load_objects(tmp_path)
    assert catalog[name].symmetry == "box"
    assert name in catalog
    assert catalog[unicodedata.normalize("NFD", "Schüssel")] is catalog[name]


@pytest.mark.parametrize(
    ("scale", "offers"),
    [(100.0, ["0.2 m in 'cm'", "0.02 m in 'mm'"]), (1000.0, ["0.2 m in 'mm'", "2 m in 'cm'"])],
)
def test_every_unit_that_fits_is_offered_with_its_size(tmp_path, scale, offers):
    box(tmp_path / "cup.stl", scale * 0.9999)
    with pytest.raises(MeshUnitError) as raised:
        load_objects(tmp_path)
    for offer in offers:
        assert offer in str(raised.value)


def test_a_small_thing_in_centimetres_is_remarked_or_refused(tmp_path, caplog):
    box(tmp_path / "cap.stl", 1.0, np.array([0.9, 1.2, 1.5]))
    with caplog.at_level(logging.WARNING):
        load_objects(tmp_path)
    assert "0.015 m in 'cm'" in caplog.text


@pytest.mark.parametrize("ending", ["glb", "stl", "obj"])
def test_a_ground_plane_is_left_out_and_remarked(tmp_path, caplog, ending):
    cup = trimesh.creation.cylinder(0.035, 0.12)
    plane = trimesh.creation.box((2.0, 2.0, 0.001))
    plane.apply_translation((0, 0, -0.0606))
    scene = trimesh.Scene([cup, plane])
    (scene if ending == "glb" else scene.to_mesh()).export(tmp_path / f"cup.{ending}")
    for _ in range(2):  # built, and from the cache
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            model = load_objects(tmp_path)["cup"]
        assert model.length == pytest.approx(0.12, rel=0.01)
        assert "ground plane" in caplog.text


def test_two_bodies_of_one_object_stay(tmp_path, caplog):
    lid = trimesh.creation.box((0.2, 0.2, 0.003))
    lid.apply_translation((0, 0, 0.2))
    trimesh.Scene([trimesh.creation.box((0.19, 0.19, 0.1)), lid]).to_mesh().export(
        tmp_path / "pot.stl"
    )
    assert load_objects(tmp_path)["pot"].vertices[:, 2].max() > 0.19
    assert caplog.text == ""


def test_the_package_that_is_missing_is_named(tmp_path, monkeypatch):
    (tmp_path / "cup.dae").write_text("<COLLADA/>")
    readable = set(trimesh.available_formats()) - {"dae", "3mf"}
    monkeypatch.setattr(mesh_folder.trimesh, "available_formats", lambda: readable)
    with pytest.raises(ObjectsError, match=r"\.dae needs pycollada: pip install .*'pycollada>="):
        load_objects(tmp_path)


def test_what_a_folder_without_meshes_holds_is_named(tmp_path):
    (tmp_path / "cup.step").write_text("ISO-10303-21;")
    with pytest.raises(ObjectsError, match=r"holds no mesh.*found \.step"):
        load_objects(tmp_path)


def test_a_table_with_a_byte_order_mark(tmp_path):
    box(tmp_path / "cup.stl", 1000.0)
    (tmp_path / "objects.toml").write_bytes(b'\xef\xbb\xbf[cup]\nunit = "mm"')
    assert load_objects(tmp_path)["cup"].length == pytest.approx(0.2)


@pytest.mark.parametrize("ending", ["obj", "stl", "glb", "ply"])
def test_a_body_far_from_the_rest_is_remarked(tmp_path, caplog, ending):
    body = trimesh.creation.box(SIZE)
    near = trimesh.creation.icosphere(radius=0.004).apply_translation((0.05, 0.0, 0.0))
    far = trimesh.creation.icosphere(radius=0.004).apply_translation((0.4, 0.0, 0.0))
    for name, bodies, said in (("whole", [body, near], False), ("stray", [body, far], True)):
        folder = tmp_path / name
        folder.mkdir()
        trimesh.util.concatenate(bodies).export(folder / f"mug.{ending}")
        caplog.clear()
        load_objects(folder)
        assert ("1 of its 2 bodies lie apart" in caplog.text) is said


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_texts_beside_meshes_in_any_encoding(tmp_path, encoding):
    box(tmp_path / "mug.stl", 1000.0)
    (tmp_path / "objects.toml").write_bytes('[mug]\nunit = "mm"\n'.encode(encoding))
    box(tmp_path / "bop" / "obj_000001.ply", 1000.0)
    info = json.dumps({"1": {"diameter": 220.0}})
    (tmp_path / "bop" / "models_info.json").write_bytes(info.encode(encoding))
    assert load_objects(tmp_path)["mug"].length == pytest.approx(0.2)
    assert load_objects(tmp_path / "bop")["obj_000001"].length == pytest.approx(0.2)
