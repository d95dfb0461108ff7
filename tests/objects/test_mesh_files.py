"""Where meshes come from: folders with their table, primitives, the YCB set."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from igrip import Catalog, IgripError, load_objects
from igrip.errors import MeshUnitError, ObjectsError
from igrip.objects.mesh_files import MeshOptions, parse_primitive
from igrip.objects.mesh_folder import folder_meshes, ycb_meshes
from support import PAPER

SIZE = np.array([0.05, 0.08, 0.2])
SHIFT = np.array([0.3, -0.1, 0.4])


def bottle(scale=1.0):
    """Return a shape that is off the origin."""
    mesh = trimesh.creation.box(SIZE)
    mesh.apply_translation(SHIFT)
    mesh.apply_scale(scale)
    return mesh


def write(folder, name, scale=1.0, table=None):
    bottle(scale).export(folder / name)
    if table is not None:
        (folder / "objects.toml").write_text(table)
    return folder


@pytest.mark.parametrize("suffix", ["ply", "stl", "obj", "off", "glb", "STL", "Ply"])
def test_formats(tmp_path, suffix):
    bottle().export(tmp_path / f"bottle.{suffix}", file_type=suffix.lower())
    catalog = load_objects(tmp_path)
    assert list(catalog) == ["bottle"]
    model = catalog["bottle"]
    expected = bottle()
    assert model.length == pytest.approx(0.2, rel=0.01)
    assert model.vertices.min(axis=0) == pytest.approx(expected.vertices.min(axis=0), abs=1e-6)
    assert model.centre == pytest.approx(expected.center_mass, abs=1e-5)


@pytest.mark.parametrize(
    ("unit", "scale"), [("m", 1.0), ("cm", 100.0), ("mm", 1000.0), ("in", 1 / 0.0254)]
)
def test_units(tmp_path, unit, scale):
    table = f'[bottle]\nunit = "{unit}"\n'
    model = load_objects(write(tmp_path, "bottle.ply", scale, table))["bottle"]
    assert model.length == pytest.approx(0.2, rel=1e-3)
    assert model.centre == pytest.approx(bottle().center_mass, rel=1e-4)


def test_a_mesh_in_millimetres_is_refused_with_the_lines_to_add(tmp_path):
    write(tmp_path, "mustard.stl", 1000.0)
    with pytest.raises(MeshUnitError) as raised:
        load_objects(tmp_path)
    text = str(raised.value)
    assert isinstance(raised.value, ObjectsError)
    assert str(tmp_path / "objects.toml") in text
    lines = '[mustard]\nunit = "mm"'
    assert lines in text
    (tmp_path / "objects.toml").write_text(lines)
    assert load_objects(tmp_path)["mustard"].length == pytest.approx(0.2, rel=1e-3)


def test_a_mesh_that_is_declared_too_small_is_refused_too(tmp_path):
    write(tmp_path, "mustard.stl", 1.0, '[mustard]\nunit = "mm"')
    with pytest.raises(MeshUnitError, match='unit = "m"'):
        load_objects(tmp_path)


def test_defaults_of_the_table(tmp_path):
    write(tmp_path, "a.ply", 1000.0)
    write(tmp_path, "b.ply", 1.0, '[defaults]\nunit = "mm"\nsymmetry = "cylinder"\n[b]\nunit="m"\n')
    catalog = load_objects(tmp_path)
    assert set(catalog) == {"a", "b"}
    for name in catalog:
        assert catalog[name].length == pytest.approx(0.2, rel=1e-3)
        assert catalog[name].symmetry == "cylinder"


def test_frame_of_the_box(tmp_path):
    model = load_objects(write(tmp_path, "bottle.ply", table='[bottle]\nframe = "box"\n'))["bottle"]
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    assert low + high == pytest.approx(np.zeros(3), abs=1e-7)
    mesh = bottle()
    assert model.centre == pytest.approx(mesh.center_mass - mesh.bounds.mean(axis=0), abs=1e-6)
    assert np.ptp(model.vertices, axis=0) == pytest.approx(SIZE)


def test_alias_axis_and_symmetry(tmp_path):
    table = '[bottle]\nalias = ["flask", "9"]\naxis = [1.0, 0.0, 0.0]\nsymmetry = "box"\n'
    catalog = load_objects(write(tmp_path, "bottle.ply", table=table))
    assert catalog["flask"] is catalog["9"] is catalog["bottle"]
    assert list(catalog) == ["bottle"]
    assert len(catalog) == 1
    assert "flask" in catalog
    assert catalog["flask"].name == "bottle"
    assert catalog["bottle"].axis == pytest.approx([1.0, 0.0, 0.0])
    assert catalog["bottle"].symmetry == "box"


def test_one_file_under_two_names(tmp_path):
    table = '[one]\nfile = "bottle.ply"\n[two]\nfile = "bottle.ply"\naxis = [1, 0, 0]\n'
    catalog = load_objects(write(tmp_path, "bottle.ply", table=table))
    assert set(catalog) == {"one", "two"}
    assert abs(catalog["one"].axis[2]) > 0.99
    assert catalog["two"].axis == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("[bottle", ["objects.toml"]),
        ("bottle = 3", ["bottle", "table"]),
        ('[bottle]\nunit = "km"', ["bottle", "unit"]),
        ("[bottle]\nunti = 3", ["bottle", "unti"]),
        ("[bottle]\naxis = [1.0, 0.0]", ["bottle", "axis"]),
        ("[bottle]\naxis = [0.0, 0.0, 0.0]", ["bottle", "axis"]),
        ("[bottle]\naxis = [nan, 0.0, 1.0]", ["bottle", "axis"]),
        ('[bottle]\nframe = "world"', ["bottle", "frame"]),
        ('[bottle]\nsymmetry = "round"', ["bottle", "symmetry"]),
        ('[mug]\nunit = "m"', ["mug", "found none"]),
        ('[mug]\nfile = "mug.stl"', ["mug", "does not exist"]),
        ('[a]\nfile="bottle.ply"\nalias=["x"]\n[b]\nfile="bottle.ply"\nalias=["x"]', ["'x'"]),
        ('[a]\nfile="bottle.ply"\nalias=["b"]\n[b]\nfile="bottle.ply"', ["'b'"]),
        ('[a]\nfile="bottle.ply"\n[b]\nfile="bottle.ply"\nalias=["a"]', ["'a'"]),
        ('[bottle]\nfile = "objects.toml"', ["objects.toml"]),
    ],
)
def test_a_wrong_table_says_where(tmp_path, table, words):
    write(tmp_path, "bottle.ply", table=table)
    with pytest.raises(ObjectsError) as raised:
        load_objects(tmp_path)
    for word in words:
        assert word in str(raised.value)


def test_a_table_that_is_no_text(tmp_path):
    write(tmp_path, "bottle.ply")
    (tmp_path / "objects.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ObjectsError, match=r"objects\.toml"):
        load_objects(tmp_path)


def test_two_files_of_one_object(tmp_path):
    write(tmp_path, "bottle.stl")
    write(tmp_path, "bottle.ply")
    [mesh] = folder_meshes(tmp_path)
    assert (mesh.name, mesh.path.name) == ("bottle", "bottle.ply")
    (tmp_path / "objects.toml").write_text('[bottle]\nunit = "m"')
    [mesh] = folder_meshes(tmp_path)
    assert (mesh.path.name, mesh.options.unit) == ("bottle.ply", "m")
    (tmp_path / "objects.toml").write_text('[bottle]\nfile = "bottle.stl"')
    [mesh] = folder_meshes(tmp_path)
    assert mesh.path.name == "bottle.stl"


def test_one_name_in_two_folders(tmp_path):
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        write(tmp_path / name, "bottle.ply")
    with pytest.raises(ObjectsError, match="two objects are named 'bottle'"):
        load_objects(tmp_path / "first", tmp_path / "second")
    same_twice = load_objects(tmp_path / "first", tmp_path / "first")
    assert list(same_twice) == ["bottle"]


CORRUPT = {
    "empty.stl": b"",
    "noise.stl": bytes(range(256)) * 4,
    "cut.ply": b"ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\n",
    "points.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "text.off": b"this is no mesh\n",
    "nan.obj": b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n",
    "line.obj": b"v 0 0 0\nv 0.1 0 0\nv 0.2 0 0\nf 1 2 3\n",
}


@pytest.mark.parametrize("name", CORRUPT)
@pytest.mark.filterwarnings("ignore")  # the readers' own
def test_corrupt_files(tmp_path, name):
    (tmp_path / name).write_bytes(CORRUPT[name])
    with pytest.raises(ObjectsError) as raised:
        load_objects(tmp_path)
    assert name.partition(".")[0] in str(raised.value)


def test_a_file_that_is_gone_is_reported_as_any_other_wrong_file(tmp_path):
    catalog = Catalog(write(tmp_path, "bottle.ply"))
    (tmp_path / "bottle.ply").unlink()
    with pytest.raises(ObjectsError, match="bottle"):
        catalog["bottle"]


def test_empty_and_missing_folders(tmp_path):
    with pytest.raises(ObjectsError, match="holds no mesh"):
        load_objects(tmp_path)
    with pytest.raises(ObjectsError, match="expected 'ycb', a folder"):
        load_objects(tmp_path / "nowhere")
    with pytest.raises(ObjectsError, match="at least one source"):
        load_objects()
    (tmp_path / "readme.txt").write_text("no mesh")
    with pytest.raises(ObjectsError, match="holds no mesh"):
        load_objects(tmp_path)


# primitives --------------------------------------------------------------------------------------


def test_box():
    model = load_objects("box:0.07x0.16x0.21")["box:0.07x0.16x0.21"]
    assert np.ptp(model.vertices, axis=0) == pytest.approx([0.07, 0.16, 0.21])
    assert model.axis == pytest.approx([0.0, 0.0, 1.0])
    assert model.length == pytest.approx(0.21)
    assert model.symmetry == "box"
    assert model.centre == pytest.approx(np.zeros(3), abs=1e-12)
    edges = trimesh.Trimesh(model.vertices, model.faces).edges_unique_length
    assert edges.max() < 0.0106  # the nearest vertex is not far from the nearest point


def test_cylinder():
    model = load_objects("cylinder:0.08x0.05")["cylinder:0.08x0.05"]
    assert model.axis == pytest.approx([0.0, 0.0, 1.0])  # though it is wider than high
    assert model.length == pytest.approx(0.05)
    assert model.radius == pytest.approx(0.08, rel=1e-3)
    assert model.symmetry == "cylinder"


@pytest.mark.parametrize(
    "text",
    ["box:0.1x0.2", "box:0.1x0.2x0.3x0.4", "box:0.1", "cylinder:0.1", "cylinder:0.1x0.2x0.3",
     "box:0x0.1x0.1", "box:-0.1x0.1x0.1", "box:70x160x210", "box:1e999x1x1", "box:1e-9x1x1",
     "box:1.2.3x1x1", "cylinder:e1x0.1", "box:1e1e1x1x1"],
)  # fmt: skip
def test_primitives_that_make_no_sense(text):
    with pytest.raises(ObjectsError, match="in metres"):
        load_objects(text)


@pytest.mark.parametrize("text", ["box", "box:", "box:axbxc", "sphere:0.1", "ycbv", "cylinder"])
def test_texts_that_are_no_primitives(text):
    assert parse_primitive(text) is None
    with pytest.raises(IgripError):
        load_objects(text)


def test_several_sources(tmp_path):
    catalog = load_objects(write(tmp_path, "bottle.ply"), "ycb", "box:0.1x0.1x0.2")
    assert len(catalog) == 80
    assert {"bottle", "box:0.1x0.1x0.2", *PAPER} <= set(catalog)


def test_options_are_known_by_what_is_written():
    assert MeshOptions() == MeshOptions(frame="mesh", symmetry="none", alias=())
    primitive = parse_primitive("cylinder:0.033x0.10")
    assert primitive.size == (0.033, 0.10)
    assert primitive.digest() != parse_primitive("cylinder:0.033x0.11").digest()


def test_the_ycb_set():
    meshes = ycb_meshes()
    assert len(meshes) == 78
    assert all(mesh.options.unit == "m" for mesh in meshes)
    assert [mesh.name for mesh in meshes] == sorted(mesh.name for mesh in meshes)


def test_the_digest_goes_by_content_and_options(tmp_path):
    digests = []
    for scale, table in ((1.0, ""), (1.0, '[bottle]\nframe = "box"'), (1.01, "")):
        [mesh] = folder_meshes(write(tmp_path, "bottle.ply", scale, table))
        digests.append(mesh.digest())
    assert len(set(digests)) == 3
    [again] = folder_meshes(write(tmp_path, "bottle.ply"))
    assert again.digest() == digests[0]
