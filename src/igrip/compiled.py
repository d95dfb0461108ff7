"""Compilation of the numeric kernels, with a cache on disk that notices every edit.

numba keys its cache by the file of the compiled function alone: an edited callee in another file
would go unnoticed and the old result be returned. The same holds for an edited named tuple that a
kernel reads. So the cache directory carries a hash of all sources with either.
"""

from __future__ import annotations

import hashlib
import logging
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import event
from platformdirs import user_cache_path

log = logging.getLogger(__name__)


@cache
def cache_directory() -> Path:
    """Return a writable directory for results that can be computed again.

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


def kernel_sources(root: Path) -> list[Path]:
    """Return every source file of a package with a kernel or a type that kernels read, sorted."""
    texts = ((path, path.read_bytes()) for path in sorted(root.rglob("*.py")))
    return [path for path, text in texts if b"@kernel" in text or b"(NamedTuple)" in text]


@cache
def kernel_cache_directory() -> Path:
    """Return the directory of compiled code for the sources as they are now."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in kernel_sources(Path(__file__).parent):
        digest.update(source.read_bytes())
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


class _Announcer(event.Listener):  # type: ignore[misc]
    """Log the first compilation of a process; what comes from the cache is not compiled."""

    announced = False

    def on_start(self, event: Any) -> None:
        """Log it."""
        function = event.data["dispatcher"].py_func
        if not self.announced and function.__module__.startswith(__package__ + "."):
            self.announced = True
            log.info(
                "compiling the kernels, once on this machine; it takes up to a minute "
                "(igrip doctor --warm-up does it beforehand)"
            )

    def on_end(self, event: Any) -> None:
        """Do nothing."""


event.register("numba:compile", _Announcer())
