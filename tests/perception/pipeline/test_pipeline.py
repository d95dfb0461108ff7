"""Camera, hands and objects at their own rates: newest wins, ticks in silence, clean ends."""

from __future__ import annotations

import threading

import pytest

from igrip.errors import CameraError, IgripError
from igrip.perception.pipeline.pipeline import Pipeline
from igrip.runtime.loop import TICK
from live_fakes import LIMIT, Clock, FakeCamera, hand_stage, object_stage


class Counter:
    """Counts up, and lets others wait for a count."""

    def __init__(self):
        self.count, self._change = 0, threading.Condition()

    def add(self, *_):
        with self._change:
            self.count += 1
            self._change.notify_all()

    def wait(self, count):
        with self._change:
            assert self._change.wait_for(lambda: self.count >= count, LIMIT)


@pytest.fixture
def clock():
    return Clock()


def hand_messages(messages):
    return [message for message in messages if message.hands]


def test_a_recording_ends_the_stream_and_its_last_frame_is_worked_on(clock):
    pipeline = Pipeline(FakeCamera(clock, 20), hand_stage, object_stage, clock)
    with pipeline:
        messages = list(pipeline)
    times = [message.t for message in messages]
    assert times == sorted(times)
    assert hand_messages(messages)[-1].hands["right"].t == pytest.approx(20 / 30)
    assert [m for m in messages if m.objects][-1].objects["box"].t == pytest.approx(20 / 30)


def test_hands_come_at_their_rate_however_slow_objects_are(clock):
    read, begun, release, given = Counter(), threading.Event(), threading.Event(), []

    def before(k):
        read.wait(k)  # every message of a hand is read before the next frame
        if k == 1:
            assert begun.wait(LIMIT)

    def slow(frame, hands):
        given.append(hands)
        begun.set()
        assert release.wait(LIMIT)

    pipeline = Pipeline(
        FakeCamera(clock, 60, before), hand_stage, lambda: object_stage(slow), clock
    )
    messages = []
    with pipeline:
        for message in pipeline:
            messages.append(message)
            if message.hands:
                read.add()
            if read.count == 60:
                release.set()
    ages = [message.t - message.hands["right"].t for message in hand_messages(messages)]
    assert ages == pytest.approx([0.0] * 60)
    assert len(given) == 2
    assert any(message.objects for message in messages)
    report = pipeline.report()
    assert report["camera: objects"]["skipped"] == 58
    assert report["camera: hands"]["skipped"] == 0
    assert given[1].frame.t == pytest.approx(clock())  # objects are given the newest hands


def test_a_slow_reader_gets_the_newest_and_no_queue(clock):
    worked = Counter()
    camera = FakeCamera(clock, 40, worked.wait)
    pipeline = Pipeline(camera, lambda: hand_stage(worked.add), None, clock)
    with pipeline:
        hands = (message for message in pipeline if message.hands)
        first = next(hands)
        worked.wait(40)
        hands = [first, *hands]
    assert len(hands) <= 3
    assert hands[-1].hands["right"].t == pytest.approx(40 / 30)
    assert pipeline.replaced == 40 - len(hands)


def test_there_are_ticks_in_silence(clock):
    pipeline = Pipeline(FakeCamera(clock, 1, endless=True), hand_stage, None, clock)
    with pipeline:
        messages = iter(pipeline)
        assert next(messages).hands
        for _ in range(5):
            clock.advance(TICK + 0.01)
            tick = next(messages)
            assert not tick.hands
            assert tick.t == pytest.approx(clock() - pipeline.begin)


def test_a_camera_that_fails_ends_the_stream_with_its_error(clock):
    camera = FakeCamera(clock, 5, error=CameraError("unplugged"))
    pipeline = Pipeline(camera, hand_stage, None, clock)
    with pipeline, pytest.raises(CameraError, match="unplugged"):
        list(pipeline)


def failing(worked, fails):
    def work(frame):
        worked.add()
        if fails(worked.count):
            raise ValueError("a strange picture")

    return work


def test_a_frame_that_fails_costs_itself_alone(clock):
    worked = Counter()
    work = failing(worked, lambda n: n % 3 == 0)
    pipeline = Pipeline(FakeCamera(clock, 30, worked.wait), lambda: hand_stage(work), None, clock)
    with pipeline:
        hands = hand_messages(pipeline)
    assert len(hands) + pipeline.replaced == 20
    assert pipeline.report()["camera: hands"]["failed"] == 10


def test_a_stage_that_always_fails_ends_the_stream_with_its_error(clock):
    worked = Counter()
    camera = FakeCamera(clock, 30, worked.wait, endless=True)
    work = failing(worked, lambda n: True)
    pipeline = Pipeline(camera, lambda: hand_stage(work), None, clock)
    with pipeline, pytest.raises(IgripError, match="hands of camera: a strange picture"):
        list(pipeline)


def test_closing_from_another_thread_ends_it(clock):
    pipeline = Pipeline(FakeCamera(clock, endless=True), hand_stage, object_stage, clock)
    with pipeline:
        messages = iter(pipeline)
        first = next(messages)
        closing = threading.Thread(target=pipeline.close)
        closing.start()
        rest = list(messages)
        closing.join(10.0)
    assert not closing.is_alive()
    assert all(message.t >= first.t for message in rest)
    assert next(messages, None) is None


def test_no_thread_is_left_and_stages_are_closed(clock):
    closed = []

    class Stage:
        def __init__(self):
            self.detect = hand_stage()

        def __call__(self, frame):
            return self.detect(frame)

        def close(self):
            closed.append(threading.current_thread().name)

    before = set(threading.enumerate())
    with Pipeline(FakeCamera(clock, endless=True), Stage, object_stage, clock) as pipeline:
        next(iter(pipeline))
    assert set(threading.enumerate()) == before
    assert closed == ["igrip-camera: hands"]


def test_each_camera_has_its_own_stages(clock):
    made = []

    def new():
        made.append(1)
        return hand_stage()

    pipeline = Pipeline(FakeCamera(clock, cameras=("a", "b")), new, None, clock)
    with pipeline:
        list(pipeline)
    assert len(made) == 2
    assert set(pipeline.latest_hands()) == {"a", "b"}
    assert {"a: hands", "b: hands"} <= set(pipeline.report())
