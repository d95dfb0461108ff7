"""Compilation of the numeric kernels, with a cache on disk that notices every edit.

numba keys its cache by the file of the compiled function alone: an edited callee in another file
would go unnoticed and the old result be returned. So the cache directory carries a hash of all
kernel sources.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
from platformdirs import user_cache_path

KERNEL_SOURCES = (
    "compiled.py",
    "motion/low_pass.py",
    "motion/quadratic.py",
    "motion/kinematics.py",
    "motion/noise.py",
    "motion/reach.py",
    "geometry/bvh.py",
    "geometry/cones.py",
    "geometry/contact.py",
    "geometry/cylinder.py",
    "geometry/local.py",
    "geometry/nearest.py",
    "geometry/ray.py",
    "geometry/within.py",
    "geometry/kernel.py",
    "simulation/render/draw.py",
    "vision/registration/field.py",
    "vision/registration/align.py",
    "vision/registration/evidence.py",
    "vision/registration/near.py",
    "vision/registration/starts.py",
    "cues/distance.py",
    "cues/distance_derivative.py",
    "cues/impacts.py",
    "targets/weighted.py",
    "targets/features.py",
    "targets/network.py",
    "targets/bayes.py",
    "grips/contact.py",
)


@cache
def cache_directory() -> Path:
    """Return a writable directory for what can be computed again.

    ``IGRIP_CACHE_DIR`` names it; by default it is the user's cache directory, and where that cannot
    be written, a temporary one.
    """
    chosen = os.environ.get("IGRIP_CACHE_DIR")
    path = Path(chosen) if chosen else user_cache_path("igrip")
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError:
        return Path(tempfile.mkdtemp(prefix="igrip-cache-"))


@cache
def kernel_cache_directory() -> Path:
    """Return the directory of compiled code for the sources as they are now."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in KERNEL_SOURCES:
        digest.update((Path(__file__).parent / source).read_bytes())
    return cache_directory() / "kernel" / digest.hexdigest()[:16]


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function when it is first called; without the GIL and without fast-math."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(kernel_cache_directory())
    try:
        compiled: Callable[..., Any] = numba.njit(
            nogil=True, cache=True, fastmath=False, error_model="numpy"
        )(function)
    finally:
        numba.config.CACHE_DIR = before
    return compiled
