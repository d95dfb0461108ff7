"""Names of things in a TOML file: read, given, replaced, refused."""

import tomllib

import numpy as np
import pytest

import igrip
from igrip.errors import IgripError
from igrip.perception.shapes.look import Look
from igrip.perception.shapes.names import give_name, read_names, write_names

MUG = Look(np.array([0.112, 0.09, 0.082]), np.array([34.0, 52.0, 121.0]))
BOX = Look(np.array([0.2, 0.16, 0.07]), np.array([190.0, 40.0, 30.0]))


@pytest.fixture
def catalog():
    return igrip.load_objects("box:0.01x0.02x0.03")


def test_a_name_that_is_given_is_read_again(tmp_path, catalog):
    path = tmp_path / "names.toml"
    give_name(path, "object_1", "  my   mug ", MUG, catalog)
    (found,) = read_names(path, catalog)
    assert found.name == "my mug"
    assert found.look.is_like(MUG)
    assert not found.look.is_like(BOX)


def test_it_replaces_what_the_thing_was_called(tmp_path, catalog):
    path = tmp_path / "names.toml"
    write_names(path, {"object_1": MUG, "object_2": BOX})
    give_name(path, "object_1", 'the "blue" mug', MUG, catalog)
    give_name(path, "object_2", "box", BOX, catalog)
    give_name(path, "box", "carton", BOX, catalog)
    assert list(tomllib.loads(path.read_text())) == ['the "blue" mug', "carton"]


def test_an_entry_of_another_run_that_looks_otherwise_stays(tmp_path, catalog):
    path = tmp_path / "names.toml"
    write_names(path, {"object_1": BOX})
    give_name(path, "object_1", "my mug", MUG, catalog)
    assert list(tomllib.loads(path.read_text())) == ["object_1", "my mug"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("", "1 to 60 characters"), (" " * 4, "1 to 60 characters"), ("x" * 61, "1 to 60"),
        ("a\x00b", "1 to 60 characters"), ("none", "taken"), ("object_3", "taken"),
        ("box:0.01x0.02x0.03", "taken"), ("carton", "another thing is called 'carton'"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_name_is_refused(tmp_path, catalog, name, words):
    path = tmp_path / "names.toml"
    write_names(path, {"carton": BOX})
    before = path.read_text()
    with pytest.raises(IgripError, match=words):
        give_name(path, "object_1", name, MUG, catalog)
    assert path.read_text() == before


def test_a_file_that_cannot_be_written_is_named(tmp_path, catalog):
    with pytest.raises(IgripError, match="cannot be written"):
        give_name(tmp_path / "nowhere" / "names.toml", "object_1", "my mug", MUG, catalog)
