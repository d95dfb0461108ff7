"""Files of meshes that ask for more than they hold, or are written in other ways."""

from __future__ import annotations

import json
import tracemalloc
import zipfile

import numpy as np
import pytest
import trimesh

from igrip.errors import ObjectsError
from igrip.objects.mesh_files import MeshFile, MeshOptions
from igrip.objects.mesh_reader import read_mesh_file

SIZE = (0.05, 0.08, 0.2)


def box(path):
    trimesh.creation.box(SIZE).export(path)
    return path


def glb_with(path, change):
    """Write a box as GLB whose JSON was changed, with the right lengths."""
    data = box(path).read_bytes()
    length = int.from_bytes(data[12:16], "little")
    header = json.loads(data[20 : 20 + length])
    change(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    total = 20 + len(text) + len(rest)
    path.write_bytes(
        data[:8] + total.to_bytes(4, "little") + len(text).to_bytes(4, "little") + b"JSON" + text
        + rest
    )  # fmt: skip
    return path


def taken(path):
    """Return the error and the peak of memory [bytes] of reading a file."""
    box(path.parent / "first.stl")
    read_mesh_file(path.parent / "first.stl")
    tracemalloc.start()
    try:
        with pytest.raises(ObjectsError) as raised:
            MeshFile("box", path, MeshOptions()).read()
        return str(raised.value), tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_chunk_that_says_it_is_huge_allocates_nothing(tmp_path):
    path = box(tmp_path / "box.glb")
    data = bytearray(path.read_bytes())
    length = int.from_bytes(data[12:16], "little")
    data[20 + length : 24 + length] = (1 << 30).to_bytes(4, "little")
    path.write_bytes(bytes(data))
    _, peak = taken(path)
    assert peak < 2**20


@pytest.mark.parametrize("accessor", [
    {"componentType": 5126, "type": "VEC3", "count": 500_000_000},
    {"componentType": 5125, "type": "SCALAR", "count": 1e12},
    {"componentType": 5125, "type": "SCALAR", "count": "many"},
])  # fmt: skip
def test_an_accessor_of_more_than_there_is_is_refused(tmp_path, accessor):
    path = glb_with(tmp_path / "box.glb", lambda header: header["accessors"].append(accessor))
    text, peak = taken(path)
    assert "box.glb" in text
    assert peak < 2**20


def test_bodies_count_as_often_as_they_are_placed(tmp_path, monkeypatch):
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(SIZE), geom_name="body", node_name="first")
    for k in range(20):
        scene.graph.update(f"node {k}", geometry="body")
    path = tmp_path / "box.glb"
    scene.export(path)
    assert len(read_mesh_file(path).to_mesh().faces) == 21 * 12
    monkeypatch.setattr("igrip.objects.mesh_reader.MAX_FACES", 21 * 12 - 1)
    text, _ = taken(path)
    assert "has 252 faces, more than 251: simplify it" in text


def test_the_compression_that_cannot_be_read_is_named(tmp_path):
    def change(header):
        header["extensionsRequired"] = ["KHR_draco_mesh_compression"]

    text, _ = taken(glb_with(tmp_path / "box.glb", change))
    assert "KHR_draco_mesh_compression" in text
    assert "export it without compression" in text


def test_an_archive_that_becomes_huge_is_refused(tmp_path):
    path = tmp_path / "box.3mf"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", b"0" * 50_000_000)
    text, peak = taken(path)
    assert "decompressed" in text
    assert peak < 2**20


def test_points_of_two_numbers_are_named(tmp_path):
    path = tmp_path / "flat.obj"
    path.write_text("v 0 0\nv 0.1 0\nv 0 0.1\nf 1 2 3\n")
    text, _ = taken(path)
    assert "not triples" in text


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("ending", ["obj", "off", "ply", "gltf"])
def test_texts_with_a_byte_order_mark(tmp_path, ending, encoding):
    path = tmp_path / f"box.{ending}"
    mesh = trimesh.creation.box(SIZE)
    if ending == "ply":
        path.write_bytes(mesh.export(file_type="ply", encoding="ascii"))
    elif ending == "gltf":
        for name, data in mesh.export(file_type="gltf").items():
            (tmp_path / name.replace("model.gltf", path.name)).write_bytes(data)
    else:
        path.write_text("\n".join(
            line for line in mesh.export(file_type=ending).splitlines() if not line.startswith("#")
        ))  # fmt: skip
    path.write_bytes(path.read_text().encode(encoding))
    read = MeshFile("box", path, MeshOptions()).read()
    assert read.extents == pytest.approx(SIZE, abs=1e-6)
    assert len(read.faces) == 12


def test_a_binary_stl_may_begin_with_any_bytes(tmp_path):
    path = box(tmp_path / "box.stl")
    path.write_bytes(b"\xff\xfe" + path.read_bytes()[2:])
    assert np.allclose(MeshFile("box", path, MeshOptions()).read().extents, SIZE, atol=1e-6)
