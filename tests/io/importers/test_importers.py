"""Tables in, dataset out: what was added is what was asked for, and declared."""

from pathlib import Path

import numpy as np
import pytest

from igrip import load_objects
from igrip.errors import DatasetError
from igrip.io.importers import ImportOptions, RecordedReach, find_importer, observe, read_tables

pd = pytest.importorskip("pandas", reason="the extra 'tables' is not installed")


def reach(duration: float = 0.5, name: str = "r") -> RecordedReach:
    times = np.arange(int(duration * 60) + 1) / 60
    positions = np.stack([times, 2 * times, 0 * times], axis=1)
    places = {"near": np.array([0.3, 0.2, 0.07]), "far": np.array([0.6, 0.4, 0.07])}
    return RecordedReach(name, "p", "1", "right", "far", times, positions, places)


def test_resampling_and_rest() -> None:
    catalog = load_objects("cylinder:0.03x0.12")
    options = ImportOptions(mesh="cylinder:0.03x0.12", rate=30, rest=0.2)
    messages = observe(reach(), catalog, options)
    assert [m.t for m in messages] == pytest.approx(np.arange(22) / 30)  # 6 of rest, 16 of reach
    x = [m.hands["right"].position[0] for m in messages]
    assert x[:7] == [0.0] * 7
    assert x[7:] == pytest.approx(np.arange(1, 16) / 30)


def test_the_middle_of_the_mesh_stands_at_the_place() -> None:
    catalog = load_objects("ycb")
    options = ImportOptions(mesh="021_bleach_cleanser")
    first = observe(reach(), catalog, options)[0]
    model = catalog["021_bleach_cleanser"]
    for id, place in reach().places.items():
        pose = first.objects[id]
        assert pose.static
        np.testing.assert_allclose(np.array(pose.position) + model.origin, place, atol=1e-12)


def test_noise_is_what_was_asked_for_and_repeats() -> None:
    catalog = load_objects("cylinder:0.03x0.12")
    plain = ImportOptions(mesh="cylinder:0.03x0.12", rate=200)
    noisy = plain.model_copy(update={"noise": 0.004})

    def points(options: ImportOptions, name: str = "r") -> np.ndarray:
        messages = observe(reach(5.0, name), catalog, options)
        return np.array([m.hands["right"].position for m in messages])

    added = points(noisy) - points(plain)
    assert added.std() == pytest.approx(0.004, rel=0.05)
    assert abs(np.corrcoef(added[1:, 0], added[:-1, 0])[0, 1]) < 0.1
    np.testing.assert_array_equal(points(noisy), points(noisy))
    assert not np.array_equal(points(noisy, "s"), points(noisy, "r"))


def test_unknown_tables_are_refused_with_what_was_found(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("a,b\n1,2\n")
    with pytest.raises(DatasetError, match=r"no importer recognises.*t: a, b"):
        find_importer(read_tables([tmp_path]))


def test_a_file_that_is_no_table(tmp_path: Path) -> None:
    (tmp_path / "t.parquet").write_text("not parquet")
    with pytest.raises(DatasetError, match=r"t\.parquet: cannot be read as a table"):
        read_tables([tmp_path / "t.parquet"])
    with pytest.raises(DatasetError, match="expected a file"):
        read_tables([tmp_path / "t.xlsx"])
