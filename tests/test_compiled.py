"""The cache of compiled code notices every edit of a kernel's source."""

from __future__ import annotations

import ast
from pathlib import Path

import numba
import pytest

import igrip
from igrip import compiled

ROOT = Path(igrip.__file__).parent
SOURCES = [str(path.relative_to(ROOT)) for path in compiled.kernel_sources(ROOT)]


def test_every_file_with_a_type_that_kernels_read_is_part_of_the_key():
    assert {"geometry/frame_arrays.py", "geometry/packed_models.py"} <= set(SOURCES)


def test_every_file_with_a_kernel_is_part_of_the_key():
    """numba would not notice an edited callee in another file."""
    with_kernels = {
        str(path.relative_to(ROOT))
        for path in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef)
        and any(isinstance(d, ast.Name) and d.id == "kernel" for d in node.decorator_list)
    }
    assert with_kernels
    assert with_kernels | {"compiled.py"} <= set(SOURCES)


def key(monkeypatch, root):
    monkeypatch.setattr(compiled, "__file__", str(root / "compiled.py"))
    return compiled.kernel_cache_directory.__wrapped__().name


def test_an_edit_of_any_source_changes_the_directory(tmp_path, monkeypatch):
    for source in SOURCES:
        copy = tmp_path / source
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes((ROOT / source).read_bytes())
    first = key(monkeypatch, tmp_path)
    assert key(monkeypatch, tmp_path) == first
    seen = {first}
    for source in SOURCES:
        path = tmp_path / source
        path.write_bytes(path.read_bytes() + b"\n# edited\n")
        seen.add(key(monkeypatch, tmp_path))
    assert len(seen) == 1 + len(SOURCES)
    monkeypatch.setattr(numba, "__version__", "0.0")
    assert key(monkeypatch, tmp_path) not in seen


def test_kernels_are_exact_and_release_the_lock():
    from igrip.geometry import contact, kernel
    from igrip.mesh import nearest, ray
    from igrip.motion.quadratic_fit import fit_quadratic
    from igrip.motion.reach_kernel import update_reach

    for function in (
        kernel._measure, contact._approach, update_reach, ray.cast_ray, ray.meets_mesh,
        nearest.nearest, fit_quadratic,
    ):  # fmt: skip
        options = function.targetoptions
        assert options["nogil"]
        assert not options["fastmath"]
        assert options["error_model"] == "numpy"


def test_numba_keeps_its_own_directory(monkeypatch):
    before = numba.config.CACHE_DIR

    def broken(function):
        raise RuntimeError

    monkeypatch.setattr(compiled.numba, "njit", lambda **options: broken)
    with pytest.raises(RuntimeError):
        compiled.kernel(lambda x: x)
    assert before == numba.config.CACHE_DIR
