"""A scanned thing in a folder of meshes, beside others."""

import tomllib

import numpy as np
import pytest
import trimesh

import igrip
from igrip.errors import IgripError
from igrip.perception.registration.colours import read_picture
from igrip.perception.scan.catalogue_entry import Scan, check_name, write_entry

PICTURE = np.tile(np.array([30, 60, 120], dtype=np.uint8), (8, 12, 1))


def scan(size=(0.1, 0.05, 0.2), round_thing=False):
    mesh = trimesh.creation.box(size)
    mesh.apply_translation([0.0, 0.0, 0.5 * size[2]])
    return Scan(mesh, PICTURE, round_thing, {"views": 12})


def test_a_catalogue_takes_the_folder_as_it_is(tmp_path):
    folder = tmp_path / "new" / "meshes"
    check_name(folder, "my_box", replace=False)
    path = write_entry(folder, "my_box", scan())
    model = igrip.load_objects(folder)["my_box"]
    np.testing.assert_allclose(np.ptp(model.vertices, axis=0), [0.1, 0.05, 0.2], atol=1e-6)
    assert model.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert path == folder / "my_box.ply"
    np.testing.assert_array_equal(read_picture(folder / "my_box.png"), PICTURE)
    assert (folder / "my_box.json").exists()


def test_what_is_round_is_declared_so(tmp_path):
    write_entry(tmp_path, "can", scan(round_thing=True))
    model = igrip.load_objects(tmp_path)["can"]
    assert model.symmetry == "cylinder"
    np.testing.assert_allclose(model.axis, [0.0, 0.0, 1.0], atol=1e-9)


def test_other_entries_stay_and_a_replaced_one_goes(tmp_path):
    trimesh.creation.box((100.0, 40.0, 30.0)).export(tmp_path / "cad.stl")
    table = tmp_path / "objects.toml"
    table.write_text(
        '# ours\n[cad]\nunit = "mm"  # of the printer\n\n["my_box"]\nunit = "cm"\n\n'
        '[[my_box.grasps]]\nkind = "x"\n\n[my_box_2]\nunit = "mm"\n'
    )
    write_entry(tmp_path, "my_box", scan())
    text = table.read_text()
    assert "# ours" in text
    assert "# of the printer" in text
    assert tomllib.loads(text) == {
        "cad": {"unit": "mm"}, "my_box": {"file": "my_box.ply", "unit": "m"},
        "my_box_2": {"unit": "mm"},
    }  # fmt: skip
    write_entry(tmp_path, "my_box", scan((0.2, 0.1, 0.1)))
    assert text == table.read_text()


@pytest.mark.parametrize("name", ["", "a b", "../up", "none", "defaults", ".hidden", "025_mug"])
def test_what_cannot_be_a_name_is_refused(tmp_path, name):
    with pytest.raises(IgripError, match=r"cannot be a name|choose another name"):
        check_name(tmp_path, name, replace=False)


def test_what_is_there_is_replaced_only_if_asked_for(tmp_path):
    write_entry(tmp_path, "my_box", scan())
    with pytest.raises(IgripError, match=r"my_box\.ply exists: .* replace it with --replace"):
        check_name(tmp_path, "my_box", replace=False)
    check_name(tmp_path, "my_box", replace=True)
    (tmp_path / "my_box.ply").unlink()
    with pytest.raises(IgripError, match=r"has a table \[my_box\]"):
        check_name(tmp_path, "my_box", replace=False)
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "cad.stl")
    with pytest.raises(IgripError, match=r"cad\.stl exists: choose another name$"):
        check_name(tmp_path, "cad", replace=True)
