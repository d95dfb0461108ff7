"""A Dask cluster of processes of their own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from runtime_fakes import PATIENCE, until


@pytest.fixture
def cluster(tmp_path):
    """A scheduler and two workers, processes of their own; yields the address and the workers."""
    pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
    dask = str(Path(sys.executable).with_name("dask"))
    file = tmp_path / "scheduler.json"
    options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = [
        subprocess.Popen(
            [dask, "scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1",
             "--scheduler-file", str(file)], cwd=tmp_path, **options,
        )
    ]  # fmt: skip
    until(lambda: file.exists() and file.stat().st_size > 0)
    address = json.loads(file.read_text())["address"]
    one = [dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
           "--local-directory", str(tmp_path / "space")]  # fmt: skip
    workers = [subprocess.Popen(one, cwd=tmp_path, **options) for _ in range(2)]
    import distributed

    with distributed.Client(address, timeout=PATIENCE, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
    yield address, workers, one
    for process in [*workers, *started]:
        process.kill()
        process.wait()
