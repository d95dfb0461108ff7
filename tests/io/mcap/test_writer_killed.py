"""A recorder that is killed: its file opens and holds all but the last half second.

That is checked without a bound on the clock: a busy machine may stop the recorder anywhere. What
was written before its last flush is in the file, and each write flushes if the last flush was
0.4 s ago.
"""

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from igrip.io.mcap.reader import McapReader
from igrip.io.mcap.writer import FLUSH_EVERY

RECORDER = """
import sys, time
sys.path.insert(0, sys.argv[2])
from igrip import Observation
from igrip.io.mcap.writer import McapWriter
from rgbd_frames import frame
with McapWriter(sys.argv[1]) as writer:
    for k in range(10_000):
        writer.write_frame(frame(k))
        begin, flushed = time.monotonic(), writer._flushed
        writer.write(Observation(t=10.0 + k / 30))
        print(flushed, begin, time.monotonic(), writer._flushed, flush=True)
        time.sleep(1 / 30)
"""


@pytest.mark.parametrize(
    "seed", [*range(6), *(pytest.param(s, marks=pytest.mark.slow) for s in range(6, 60))]
)
def test_kill(tmp_path, seed):
    path = tmp_path / "x.mcap"
    command = [sys.executable, "-c", RECORDER, str(path), str(Path(__file__).parents[2])]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        first = child.stdout.readline()
        time.sleep(random.Random(seed).uniform(0.0, 2.0))
        child.send_signal(signal.SIGKILL)
        lines = [line for line in [first, *child.stdout] if line.endswith("\n")]
        writes = [tuple(map(float, line.split())) for line in lines]
    reader = McapReader(path)
    held = len(list(reader))
    assert reader.cut is not None
    assert abs(len(list(reader.frames())) - held) <= 1
    last_flush = writes[-1][3]
    assert held >= sum(end <= last_flush for _, _, end, _ in writes)
    for before, begin, _, after in writes:
        assert after >= begin or begin - before < FLUSH_EVERY
    assert held <= len(writes) + 1


FULL = """
import resource, signal, sys, time
sys.path.insert(0, sys.argv[2])
from igrip.errors import RecordingError
from igrip.io.mcap.writer import McapWriter
from rgbd_frames import frame
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (900_000, 900_000))
try:
    with McapWriter(sys.argv[1]) as writer:
        for k in range(10_000):
            writer.write_frame(frame(k))
            time.sleep(0.01)  # several chunks are flushed before the limit
except RecordingError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there are no limits of file size")
def test_a_file_that_may_not_grow(tmp_path):
    """As a full disk, by the operating system itself."""
    path = tmp_path / "x.mcap"
    command = [sys.executable, "-c", FULL, str(path), str(Path(__file__).parents[2])]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.stdout == f"{path}: File too large; what was recorded before can be read\n"
    reader = McapReader(path)
    assert len(list(reader.frames())) > 20
    assert reader.cut is not None
