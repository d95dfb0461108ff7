"""The busy processes of ``make test-busy`` end, whatever happens."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from busy import busy

FOLDER = Path(__file__).parent
KILLED = """
import os, signal
from busy import busy
with busy() as processes:
    print(*(process.pid for process in processes), flush=True)
    os.kill(os.getpid(), signal.SIGKILL)
"""


def runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_they_run_inside_the_block_only() -> None:
    with busy(3) as processes:
        assert [process.poll() for process in processes] == [None] * 3
    assert [process.returncode for process in processes] == [-signal.SIGKILL] * 3


def test_they_end_after_an_error() -> None:
    with pytest.raises(RuntimeError), busy() as processes:
        raise RuntimeError
    assert all(process.returncode is not None for process in processes)


def test_they_end_when_their_parent_is_killed() -> None:
    command = [sys.executable, "-c", KILLED]
    done = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, check=False)
    pids = [int(word) for word in done.stdout.split()]
    assert len(pids) == 2
    for _ in range(600):  # until they have noticed, however slow the machine is
        if not any(map(runs, pids)):
            return
        time.sleep(0.1)
    pytest.fail("busy processes are left")


def test_the_exit_code_is_that_of_the_command() -> None:
    command = [sys.executable, FOLDER / "busy.py", sys.executable, "-c", "raise SystemExit(7)"]
    assert subprocess.run(command, check=False).returncode == 7
