"""The loop: arrival, age, ticks, commands, and what is refused."""

from __future__ import annotations

import itertools

import pytest

import igrip
from igrip.errors import IgripError, ObservationError
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.lab.simulation.demo import DemoPerson
from igrip.lab.simulation.faults import inject
from igrip.observation import Observation
from igrip.runtime.clock_sync import ArrivalClock, RunClock, SenderClock
from igrip.runtime.loop import TICK, Loop, Sender
from igrip.runtime.protocol import Command
from igrip.runtime.stream_input import StreamInput
from runtime_fakes import SENDER, Clock, Collector, reach
from support import BOX, CAN, UPRIGHT, every_kind

EAGER = igrip.Config(targets="paper", commitment={"reliability": 0.0})


def demo(ycb, seconds):
    messages = (moment.observation for moment in DemoPerson(ycb, 2))
    return itertools.takewhile(lambda message: message.t <= seconds, messages)


def live(catalog, stream, on_update=lambda intentions: None, config=None, **options):
    """Run a live stream through a loop; return the loop and what it sent."""
    output = Collector()
    loop = Loop(
        igrip.Estimator(catalog, config), RunClock(clock=options.pop("clock", Clock())),
        {"stream": StreamInput(stream)}, {"collector": output}, **options,
    )  # fmt: skip
    with loop:
        loop.run(on_update)
    return loop, output


def as_json(intentions):
    return [intention.to_json() for intention in intentions]


def test_a_recorded_run_replays_bit_for_bit(ycb, tmp_path):
    path = tmp_path / "live.jsonl"
    with JsonlWriter(path) as file:
        loop, output = live(ycb, demo(ycb, 6.0), record=file.write)
    estimator = igrip.Estimator(ycb)
    again = [i for m in JsonlReader(path) for i in estimator.update(m)]
    assert as_json(again) == as_json(output.intentions)
    assert len(again) > 200
    assert loop.status()["intentions"] == len(again)
    assert output.closed


def test_age_counts_from_arrival_also_while_the_recorder_writes(shapes):
    clock, slow = Clock(), 0.12

    def stream():
        for message in reach():
            clock.t = message.t
            yield message

    def write(message):
        clock.t += slow

    _, output = live(shapes, stream(), config=EAGER, clock=clock, record=write)
    leases = [message for message in output.messages if message["commitment"]]
    assert len(leases) > 5
    for message in leases:
        left = message["commitment"]["valid_until"] - message["t"] - slow
        assert message["valid_for"] == pytest.approx(left, abs=2e-6)
        assert message["valid_for"] < 0.0301
        assert message["age"] == pytest.approx(slow)


def test_on_the_senders_clock_intentions_are_those_of_the_estimator(ycb):
    """However slow the machine is, and whatever faults the messages have."""
    messages = list(inject(demo(ycb, 20.0), every_kind(1.0), seed=7))
    estimator = igrip.Estimator(ycb, EAGER)
    expected = [i for m in messages for i in estimator.update(m)]
    output = Collector()
    loop = Loop(
        igrip.Estimator(ycb, EAGER), SenderClock(), outputs={"collector": output}, piped=True
    )
    for k, message in enumerate(messages):
        loop.submit(message, SENDER)
        if k % 50 == 0 or k == len(messages) - 1:  # they wait in the queue meanwhile
            while len(loop._queue):
                loop.step(0.0)
    assert as_json(output.intentions) == as_json(expected)
    for message, intention in zip(output.messages, expected, strict=True):
        lease = intention.commitment
        assert message["age"] == 0.0
        assert (message["commitment"] is None) is (lease is None)
        if lease is not None:
            left = lease.valid_until - intention.t
            assert message["valid_for"] == pytest.approx(left, abs=1e-6)
    assert sum(i.commitment is not None for i in expected) > 50


def test_silence_becomes_ticks_where_the_clock_runs_on(shapes):
    clock, output = Clock(5.0), Collector()
    loop = Loop(igrip.Estimator(shapes), ArrivalClock(clock=clock), outputs={"collector": output})
    for k in range(10):
        clock.t = 5.0 + k / 30.0
        hands = {"right": {"position": [0.0, 0.0, 0.01 * k]}}
        loop.submit(Observation(t=900.0 + k / 30.0, hands=hands), SENDER)
        loop.step(0.0)
    before = loop.estimator.inputs()["counts"]["messages"]
    loop.step(0.0)
    assert loop.estimator.inputs()["counts"]["messages"] == before == 10
    for k in range(1, 9):
        clock.t = 5.3 + k * 1.01 * TICK
        loop.step(0.0)
        assert loop.estimator.inputs()["counts"]["messages"] == before + k
    assert loop.estimator.t == pytest.approx(0.3 + 8.08 * TICK)
    assert output.intentions[-1].status == "lost"


def test_messages_that_are_refused_do_not_keep_ticks_from_the_estimator(shapes):
    clock = Clock()
    loop = Loop(igrip.Estimator(shapes), ArrivalClock(clock=clock))
    update = loop.estimator.update

    def refuse(message):
        if message.hands:
            raise ObservationError("t", "is refused")
        return update(message)

    loop.estimator.update = refuse
    clock.t = 1.1 * TICK
    loop.submit(next(reach()), SENDER)
    loop.step(0.0)
    assert loop.estimator.t == pytest.approx(1.1 * TICK)


def test_silence_is_no_time_on_the_senders_clock(shapes):
    loop = Loop(igrip.Estimator(shapes), SenderClock(), piped=True)
    loop.submit(Observation(t=3.0), SENDER)
    for _ in range(5):
        loop.step(2.0 * TICK)
    assert loop.estimator.inputs()["counts"]["messages"] == 1


def test_a_veto_ends_a_lease_at_once_and_overtakes_what_waits(shapes):
    output = Collector()
    loop = Loop(
        igrip.Estimator(shapes, EAGER), SenderClock(), outputs={"collector": output}, piped=True
    )
    messages = reach()
    while not (output.intentions and output.intentions[-1].commitment):
        loop.submit(next(messages), SENDER)
        loop.step(0.0)
    before = output.intentions[-1]
    for message in itertools.islice(messages, 5):
        loop.submit(message, SENDER)
    loop.submit(Command("veto", None), SENDER)
    loop.step(0.0)
    assert output.intentions[-1].commitment is None
    assert output.intentions[-1].t == before.t  # without another measurement
    while len(loop._queue):
        loop.step(0.0)
    assert not any(i.commitment for i in output.intentions[-5:])
    loop._update_report()
    assert loop.status()["incoming"]["veto"] == 1


def test_a_command_for_a_hand_that_no_device_assists_is_answered(shapes):
    errors = []
    config = igrip.Config(commitment={"assisted": ("right",)})
    loop = Loop(igrip.Estimator(shapes, config), SenderClock())
    loop.submit(Command("veto", "rihgt"), Sender(errors.append))
    loop.step(0.0)
    assert [error.field for error in errors] == ["hand"]
    assert "rihgt" in str(errors[0])


def test_an_object_that_is_refused_is_left_out_alone(shapes):
    """Also where its id begins like that of another."""
    errors, pose = [], {"position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}
    loop = Loop(igrip.Estimator(shapes), SenderClock())
    for t, objects in (
        (0.0, {"a": pose | {"model": BOX}, "a.b": pose | {"model": CAN}}),
        (0.1, {"a": pose, "a.b": pose | {"model": BOX}, "c": pose}),
    ):
        hands = {"right": {"position": [t, 0.0, 0.0]}}
        loop.submit(Observation(t=t, hands=hands, objects=objects), Sender(errors.append))
        loop.step(0.0)
    assert [error.field for error in errors] == ["objects.a.b.model", "objects.c.model"]
    inputs = loop.estimator.inputs()
    assert inputs["objects"]["a"]["age"] == 0.0
    assert inputs["objects"]["a.b"]["age"] == pytest.approx(0.1)
    assert inputs["hands"]["right"]["age"] == 0.0


def test_a_message_that_is_refused_is_answered_and_the_next_is_not(shapes):
    errors = []
    loop = Loop(igrip.Estimator(shapes), RunClock(clock=Clock()))
    loop.estimator.update(Observation(t=5.0))
    for t in (1.0, 6.0):
        loop.submit(Observation(t=t), Sender(errors.append))
        loop.step(0.0)
    assert [error.field for error in errors] == ["t"]
    assert loop.estimator.t == 6.0


class Broken(Collector):
    def send(self, envelope):
        super().send(envelope)
        raise BrokenPipeError


def test_an_output_without_a_receiver_is_left_and_the_others_stay(shapes):
    broken, whole = Broken(), Collector()
    loop = Loop(igrip.Estimator(shapes), SenderClock(), outputs={"a": broken, "b": whole})
    for message in reach(5):
        loop.submit(message, SENDER)
        loop.step(0.0)
    assert (len(broken.messages), len(whole.messages)) == (1, 5)
    assert not loop.abandoned
    alone = Loop(igrip.Estimator(shapes), SenderClock(), outputs={"a": Broken()})
    assert not alone.abandoned
    alone.submit(next(reach()), SENDER)
    alone.step(0.0)
    assert alone.abandoned
    assert not Loop(igrip.Estimator(shapes), SenderClock()).abandoned


def test_an_error_of_the_stream_is_raised_after_its_observations(shapes):
    def stream():
        yield from reach(5)
        raise IgripError("the camera is unplugged")

    updates = []
    with pytest.raises(IgripError, match="unplugged"):
        live(shapes, stream(), updates.append)
    assert len(updates) == 5


def test_a_stream_is_asked_for_an_observation_only_when_the_loop_is_ready(shapes):
    made = []

    def stream():
        for message in reach(20):
            made.append(message)
            yield message

    behind = []
    live(shapes, stream(), lambda intentions: behind.append(len(made) - len(behind)))
    assert behind == [1] * 20


def test_outputs_and_inputs_are_closed_whatever_happens(shapes):
    class Failing(Collector):
        single_sender = False

        def start(self, loop):
            raise IgripError("the port is taken")

    output, failing = Collector(), Failing()
    loop = Loop(igrip.Estimator(shapes), SenderClock(), {"failing": failing}, {"collector": output})
    with pytest.raises(IgripError, match="taken"), loop:
        pass
    assert output.closed
    assert failing.closed


def test_latency_is_from_measurement_to_intention(shapes):
    clock = Clock()

    def stream():
        for k in range(5):
            clock.t = k / 30.0 + 0.02
            hands = {"right": {"position": [0.0, 0.0, 0.0], "t": k / 30.0}, "left": None}
            yield Observation(t=clock.t, hands=hands)

    loop, _ = live(shapes, stream(), clock=clock)
    assert loop.latency.ages() == pytest.approx([0.02] * 5)
    assert loop.status()["update"]["age_p50_ms"] == pytest.approx(20.0)
