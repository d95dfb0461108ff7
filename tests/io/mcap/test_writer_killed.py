"""A recorder that is killed: its file opens and holds all but the last half second."""

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from igrip.io.mcap.reader import McapReader

RECORDER = """
import sys, time
sys.path.insert(0, sys.argv[2])
from igrip import Observation
from igrip.io.mcap.writer import McapWriter
from rgbd_frames import frame
with McapWriter(sys.argv[1]) as writer:
    for k in range(10_000):
        writer.write_frame(frame(k))
        writer.write(Observation(t=10.0 + k / 30))
        print(time.monotonic(), flush=True)
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
        written = [float(line) for line in [first, *child.stdout] if line.endswith("\n")]
    reader = McapReader(path)
    held = len(list(reader))
    assert reader.cut is not None
    assert abs(len(list(reader.frames())) - held) <= 1
    # by the recorder's own last sign of life, so that a busy machine does not count
    assert held >= sum(t < written[-1] - 0.5 for t in written)
    assert held <= len(written) + 1


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
