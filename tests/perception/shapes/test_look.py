"""Looks of things, and the names that are given to them."""

import numpy as np
import pytest

from igrip.errors import IgripError
from igrip.perception.shapes.look import Look, look_of
from igrip.perception.shapes.names import read_names, write_names

MUG = Look(np.array([0.11, 0.09, 0.08]), np.array([40.0, 60.0, 160.0]))


def test_a_look_is_size_and_median_colour_in_any_order_of_axes():
    corners = np.array([[0.0, 0.0, 0.0], [0.02, 0.3, 0.1]])
    look = look_of(corners, np.array([[10, 20, 30], [10, 20, 30], [255, 0, 0]], dtype=np.uint8))
    np.testing.assert_allclose(look.size, [0.3, 0.1, 0.02])
    np.testing.assert_allclose(look.colour, [10, 20, 30])


def test_what_is_larger_or_of_another_colour_is_something_else():
    assert MUG.is_like(MUG)
    assert MUG.is_like(Look(MUG.size * 1.08, MUG.colour * 0.7))  # seen anew, in less light
    assert not MUG.is_like(Look(MUG.size * [1.4, 1.0, 1.0], MUG.colour))
    assert not MUG.is_like(Look(MUG.size, MUG.colour[::-1].copy()))
    assert not MUG.is_like(Look(MUG.size, MUG.colour * 0.2))


def test_names_are_written_to_be_changed_and_read_again(tmp_path, ycb):
    path = tmp_path / "names.toml"
    assert read_names(path, ycb) == ()
    write_names(path, {"object_1": MUG})
    path.write_text(path.read_text().replace("object_1", "my mug"))
    (name,) = read_names(path, ycb)
    assert name.name == "my mug"
    assert name.look.is_like(MUG)


@pytest.mark.parametrize(
    "text",
    ["[none]\nsize=[1,1,1]\ncolour=[1,1,1]", "[025_mug]\nsize=[1,1,1]\ncolour=[1,1,1]",
     "[mug]\nsize=[1,1]\ncolour=[1,1,1]", "[mug]\nweight=3", "[mug", "mug=3"],
)  # fmt: skip
def test_a_name_that_cannot_be_used_is_explained(text, tmp_path, ycb):
    path = tmp_path / "names.toml"
    path.write_text(text)
    with pytest.raises(IgripError, match=r"names\.toml"):
        read_names(path, ycb)
