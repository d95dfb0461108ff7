"""The estimator on a live stream: recorded input replays to the same intentions, words count."""

from __future__ import annotations

import igrip
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.lab.simulation.demo import DemoPerson
from igrip.observation import Observation
from igrip.runtime.loop import Loop
from igrip.runtime.protocol import Command


class Noted:
    def __init__(self):
        self.sent = []

    def send(self, envelope):
        self.sent.append(envelope.intention)

    def close(self):
        pass

    def counts(self):
        return {"sent": len(self.sent)}


def stream(ycb, seconds):
    for moment in DemoPerson(ycb, 2):
        if moment.observation.t > seconds:
            return
        yield moment.observation


def test_what_was_recorded_replays_bit_for_bit(ycb, tmp_path):
    path = tmp_path / "live.jsonl"
    output = Noted()
    with JsonlWriter(path) as file:
        loop = Loop(igrip.Estimator(ycb), 0.0, file)
        loop.outputs.append(output)
        loop.run(stream(ycb, 6.0))
    estimator = igrip.Estimator(ycb)
    again = [i for m in JsonlReader(path) for i in estimator.update(m)]
    assert [i.to_json() for i in again] == [i.to_json() for i in output.sent]
    assert len(again) > 200
    assert loop.report()["counts"]["intentions"] == len(again)


def test_a_veto_from_outside_ends_a_lease_at_once(ycb):
    output, vetoed = Noted(), []
    loop = Loop(igrip.Estimator(ycb), 0.0)
    loop.outputs.append(output)

    def look(intentions):
        if not vetoed and any(i.commitment for i in intentions):
            vetoed.append(len(output.sent))
            loop.word(Command("veto", None))

    loop.run(stream(ycb, 8.0), look)
    told = output.sent[vetoed[0]]
    assert told.commitment is None
    assert loop.report()["counts"]["veto"] == 1


def test_observations_from_outside_are_refused(ycb):
    loop = Loop(igrip.Estimator(ycb), 0.0)
    loop.word(Observation(t=0.0))
    loop.word(Command("veto", "nobody"))
    loop.run([Observation(t=0.0), Observation(t=0.1)])
    assert loop.report()["counts"]["refused"] == 1
