"""Lines on standard output: none is lost uncounted, also at the end."""

from __future__ import annotations

import contextlib
import json
import os
import select
import threading
import types

import pytest

from igrip.intention import Intention
from igrip.runtime.envelope import Sequencer
from igrip.runtime.options import Options
from igrip.runtime.outputs import stdout
from igrip.runtime.outputs.stdout import StdoutOutput

COUNT = 200


class Pipe:
    """Stands for standard output; its reader reads when it is told to."""

    def __init__(self):
        self.reading, self.writing = os.pipe()

    def fileno(self):
        return self.writing

    def read(self, messages):
        """Read in a thread until nobody can write any more."""

        def work():
            with os.fdopen(self.reading, "rb") as file:
                messages.extend(json.loads(line) for line in file)

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        return thread


class FakeLoop:
    def __init__(self, piped):
        self.piped = piped


@pytest.fixture
def pipe(monkeypatch):
    one = Pipe()
    monkeypatch.setattr(stdout, "sys", types.SimpleNamespace(stdout=one))
    return one


def fill(output, count=COUNT, reason="x"):
    sequencer = Sequencer(lambda: 0.0)
    for k in range(count):
        intention = Intention(t=float(k), hand="right", status="idle", reason=reason)
        output.send(sequencer.wrap(intention, float(k)))


@pytest.mark.parametrize("piped", [True, False])
def test_lines_that_wait_at_the_end_are_written(pipe, piped, monkeypatch):
    monkeypatch.setattr(stdout, "CLOSE_TIMEOUT", 60.0)
    messages = []
    reader = pipe.read(messages)
    output = StdoutOutput(Options())
    output.start(FakeLoop(piped))
    fill(output)
    output.close()
    assert output.counts() == {"sent": COUNT, "lost": 0}
    os.close(pipe.writing)
    reader.join(60.0)
    assert [message["seq"] for message in messages] == list(range(1, COUNT + 1))


def test_lines_that_cannot_be_written_at_the_end_are_counted(pipe, monkeypatch):
    """The reader does not read; the pipe holds less than half of the lines."""
    monkeypatch.setattr(stdout, "CLOSE_TIMEOUT", 0.5)
    output = StdoutOutput(Options())
    output.start(FakeLoop(piped=False))
    fill(output, reason="x" * 1000)
    output.close()
    counts = output.counts()
    assert counts["sent"] + counts["lost"] == COUNT
    assert counts["lost"] > COUNT / 2
    release(pipe, output)


def test_a_reader_that_is_too_slow_loses_the_oldest_lines_counted(pipe):
    output = StdoutOutput(Options())
    output.start(FakeLoop(piped=False))
    fill(output, 1000, reason="x" * 1000)
    assert output.counts()["lost"] > 300
    reader = threading.Thread(target=release, args=(pipe, output), daemon=True)
    reader.start()
    output.close()
    reader.join(60.0)
    assert sum(output.counts().values()) == 1000


def release(pipe, output):
    """Read until the output has ended."""
    while output._thread.is_alive():
        if select.select([pipe.reading], [], [], 0.01)[0]:
            os.read(pipe.reading, 1 << 16)


@pytest.mark.parametrize("piped", [True, False])
def test_a_reader_that_has_gone_is_noticed_and_what_it_missed_is_counted(pipe, piped):
    output = StdoutOutput(Options())
    output.start(FakeLoop(piped))
    os.close(pipe.reading)
    with contextlib.suppress(BrokenPipeError):
        while True:
            fill(output, 1)
    output.close()
    counts = output.counts()
    assert counts["sent"] == 0
    assert counts["lost"] >= 1
