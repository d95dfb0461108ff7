"""Arrays on disk: the same bits again, or none; never half a file."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.objects.array_cache import read_arrays, sources_digest, write_arrays

ARRAYS = {"a": np.arange(6.0).reshape(2, 3), "b": np.array([1, 2], dtype=np.int32), "c": 0.1}


def test_what_is_written_is_read_bit_for_bit(tmp_path):
    path = tmp_path / "new folder" / "x.npz"
    write_arrays(path, ARRAYS)
    stored = read_arrays(path)
    assert stored.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(stored[name], array)
        assert stored[name].dtype == np.asarray(array).dtype
    assert [file.name for file in path.parent.iterdir()] == ["x.npz"]


def test_an_absent_file_holds_nothing(tmp_path):
    assert read_arrays(tmp_path / "x.npz") is None


@pytest.mark.parametrize("kept", [0, 1, 60, -1])
def test_a_file_that_was_cut_off_holds_nothing(tmp_path, kept):
    path = tmp_path / "x.npz"
    write_arrays(path, ARRAYS)
    path.write_bytes(path.read_bytes()[:kept])
    assert read_arrays(path) is None


def test_a_folder_that_cannot_be_made_is_no_error(tmp_path):
    (tmp_path / "file").write_text("")
    write_arrays(tmp_path / "file" / "x.npz", ARRAYS)
    assert read_arrays(tmp_path / "file" / "x.npz") is None


def test_the_digest_is_of_all_sources_in_order():
    digests = {
        sources_digest(files)
        for files in (["mesh/bvh.py"], ["mesh/ray.py"], ["mesh/bvh.py", "mesh/ray.py"])
    }
    assert len(digests) == 3
    assert sources_digest(["mesh/bvh.py"]) in digests
