"""Lines of a file as messages."""

from __future__ import annotations

import io

import igrip
from igrip.runtime.clock_sync import ArrivalClock, SenderClock
from igrip.runtime.inputs.stdin import read_lines
from igrip.runtime.loop import Loop
from runtime_fakes import reach

BAD = [b"{", b'{"t": "now"}', b"[" * 5000, b" " * 400_000, b'{"t":0,"x":"' + b"x" * 600_000, b""]


def test_malformed_lines_are_counted_and_the_rest_is_submitted(shapes):
    lines = [message.to_json() for message in reach(20)]
    lines[10:10] = BAD
    loop = Loop(igrip.Estimator(shapes), SenderClock(), piped=True)
    read_lines(io.BytesIO(b"\n".join(lines)), loop)
    loop.run()
    incoming = loop._queue.report()
    assert incoming == {"received": 20, "malformed": 4, "waiting": 0}
    assert loop.estimator.inputs()["counts"]["messages"] == 20


def test_a_command_may_come_on_a_line(shapes):
    loop = Loop(igrip.Estimator(shapes), SenderClock(), piped=True)
    read_lines(io.BytesIO(b'{"control": "veto"}\n'), loop)
    loop.run()
    assert loop._queue.counts["veto"] == 1


def test_where_there_are_other_inputs_too_the_run_goes_on_after_the_last_line(shapes):
    loop = Loop(igrip.Estimator(shapes), ArrivalClock())
    read_lines(io.BytesIO(b'{"t": 1}\n' * 300), loop)
    assert not loop._queue.finished
    assert loop._queue.report() == {"received": 300, "dropped": 44, "waiting": 256}
