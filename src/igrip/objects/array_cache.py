"""Arrays that take long to derive, kept on disk in the cache directory."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_PACKAGE = Path(__file__).parents[1]


def sources_digest(files: Iterable[str]) -> str:
    """Return a digest of source files of igrip: what they derive is derived anew when they change.

    ``files`` are paths within the package, such as ``mesh/bvh.py``.
    """
    return hashlib.sha256(b"".join((_PACKAGE / f).read_bytes() for f in files)).hexdigest()


def read_arrays(path: Path) -> dict[str, NDArray[Any]] | None:
    """Return the arrays of a file by name; None where it is absent or damaged."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except Exception:  # damaged in any of the ways numpy's reader has no one error for
        return None


def write_arrays(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write a file as a whole or not at all; a cache that cannot be written is only slow."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
        with os.fdopen(handle, "wb") as file:
            np.savez(file, **arrays)
        os.replace(temporary, path)
    except OSError:
        return
