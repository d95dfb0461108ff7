"""Reaches resampled: what is added is what was asked for."""

import numpy as np
import pytest
import trimesh

from igrip import load_objects
from igrip.errors import UnknownModelError
from igrip.io.importers import RecordedReach
from igrip.io.resampling import ImportOptions, resample


def reach(duration: float = 0.5, name: str = "r") -> RecordedReach:
    times = np.arange(int(duration * 60) + 1) / 60
    positions = np.stack([times, 2 * times, 0 * times], axis=1)
    places = {"near": np.array([0.3, 0.2, 0.07]), "far": np.array([0.6, 0.4, 0.07])}
    return RecordedReach(name, "p", "1", "right", "far", times, positions, places)


def test_resampling_and_rest() -> None:
    catalog = load_objects("cylinder:0.03x0.12")
    options = ImportOptions(mesh="cylinder:0.03x0.12", rate=30, rest=0.2)
    messages = resample(reach(), catalog, options)
    assert [m.t for m in messages] == pytest.approx(np.arange(22) / 30)  # 6 of rest, 16 of reach
    x = [m.hands["right"].position[0] for m in messages]
    assert x[:7] == [0.0] * 7
    assert x[7:] == pytest.approx(np.arange(1, 16) / 30)


def test_the_middle_of_the_mesh_stands_at_the_place() -> None:
    catalog = load_objects("ycb")
    options = ImportOptions(mesh="021_bleach_cleanser")
    first = resample(reach(), catalog, options)[0]
    model = catalog["021_bleach_cleanser"]
    for id, place in reach().object_positions.items():
        pose = first.objects[id]
        assert pose.static
        np.testing.assert_allclose(np.array(pose.position) + model.origin, place, atol=1e-12)


def test_noise_is_what_was_asked_for_and_repeats() -> None:
    catalog = load_objects("cylinder:0.03x0.12")
    plain = ImportOptions(mesh="cylinder:0.03x0.12", rate=200)
    noisy = plain.model_copy(update={"noise": 0.004})

    def points(options: ImportOptions, name: str = "r") -> np.ndarray:
        messages = resample(reach(5.0, name), catalog, options)
        return np.array([m.hands["right"].position for m in messages])

    added = points(noisy) - points(plain)
    assert added.std() == pytest.approx(0.004, rel=0.05)
    assert abs(np.corrcoef(added[1:, 0], added[:-1, 0])[0, 1]) < 0.1
    np.testing.assert_array_equal(points(noisy), points(noisy))
    assert not np.array_equal(points(noisy, "s"), points(noisy, "r"))


def test_an_object_gets_the_model_of_its_own_name(tmp_path) -> None:
    trimesh.creation.cylinder(0.04, 0.1).export(tmp_path / "near.stl")
    catalog = load_objects(tmp_path, "cylinder:0.03x0.12")
    messages = resample(reach(), catalog, ImportOptions(mesh="cylinder:0.03x0.12"))
    found = {id: pose.model for id, pose in messages[0].objects.items()}
    assert found == {"near": "near", "far": "cylinder:0.03x0.12"}
    with pytest.raises(UnknownModelError, match=r"object 'far' names no model.*has: near"):
        resample(reach(), load_objects(tmp_path), ImportOptions())
