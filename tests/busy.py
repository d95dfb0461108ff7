"""Run a command while two busy processes compete with it: ``python tests/busy.py COMMAND …``."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

# ends with its parent, even if that is killed and cannot clean up
LOOP = "import os, sys\nwhile os.getppid() == int(sys.argv[1]):\n    sum(range(100_000))\n"


@contextmanager
def busy(count: int = 2) -> Iterator[list[subprocess.Popen[bytes]]]:
    """Keep processes busy while the block runs; yield them."""
    command = [sys.executable, "-c", LOOP, str(os.getpid())]
    processes = [subprocess.Popen(command) for _ in range(count)]
    try:
        yield processes
    finally:
        for process in processes:
            process.kill()
            process.wait()


if __name__ == "__main__":
    with busy():
        sys.exit(subprocess.run(sys.argv[1:], check=False).returncode)
