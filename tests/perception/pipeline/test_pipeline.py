"""Camera, hands and objects at their own rates: newest wins, ticks in silence, clean ends."""

from __future__ import annotations

import itertools
import threading
import time

import pytest

from igrip.errors import IgripError
from igrip.perception.cameras import CameraError
from igrip.perception.pipeline.merge import TICK
from igrip.perception.pipeline.pipeline import Pipeline
from live_fakes import FakeCamera, hands_finder, objects_finder


def finders(**options):
    return lambda: hands_finder(**options)


def test_a_recording_ends_the_stream_and_its_last_frame_is_seen():
    seen = []
    chain = Pipeline(FakeCamera(count=20), finders(seen=seen), objects_finder)
    with chain:
        messages = list(chain)
    hands = [m for m in messages if m.hands]
    assert len(hands) >= 15
    assert any(m.objects for m in messages)
    times = [m.t for m in messages]
    assert times == sorted(times)
    assert hands[-1].hands["right"].t == pytest.approx(seen[-1].t - chain.begin)


def test_hands_come_at_their_rate_however_slow_objects_are():
    given = []
    chain = Pipeline(
        FakeCamera(count=60), finders(), lambda: objects_finder(takes=0.15, given=given)
    )
    with chain:
        messages = list(chain)
    hands, objects = (sum(bool(x) for x in kind) for kind in
                      ([m.hands for m in messages], [m.objects for m in messages]))  # fmt: skip
    assert hands >= 50
    assert 2 <= objects <= 8
    report = chain.report()
    assert report["camera: objects"]["skipped"] >= 40
    assert report["camera: hands"]["skipped"] <= 5
    assert any(g is not None for g in given)  # objects were told where the hands are
    ages = [m.t - m.hands["right"].t for m in messages if m.hands]
    assert max(ages) < 0.1


def test_a_slow_reader_gets_the_newest_and_no_queue():
    chain = Pipeline(FakeCamera(count=40), finders(), None)
    with chain:
        messages = []
        for message in chain:
            time.sleep(0.05)
            messages.append(message)
    assert sum(bool(m.hands) for m in messages) <= 15
    assert chain.replaced >= 20


def test_silence_is_told_by_ticks():
    chain = Pipeline(FakeCamera(rate=2.0), finders(), None)
    with chain:
        messages = list(itertools.islice(chain, 12))
    steps = [b.t - a.t for a, b in itertools.pairwise(messages)]
    assert max(steps) < TICK + 0.05
    assert sum(not m.hands and not m.objects for m in messages) >= 8


def test_a_camera_that_fails_ends_the_stream_with_its_error():
    chain = Pipeline(FakeCamera(count=5, error=CameraError("unplugged")), finders(), None)
    with chain, pytest.raises(CameraError, match="unplugged"):
        list(chain)


def test_a_frame_that_fails_costs_itself_alone():
    chain = Pipeline(FakeCamera(count=30), finders(fails=lambda n: n % 3 == 0), None)
    with chain:
        messages = list(chain)
    assert sum(bool(m.hands) for m in messages) >= 15
    assert chain.report()["camera: hands"]["failed"] >= 8


def test_a_finder_that_always_fails_is_said_to():
    chain = Pipeline(FakeCamera(rate=500.0), finders(fails=lambda n: True), None)
    with chain, pytest.raises(IgripError, match="hands of camera: a strange picture"):
        list(chain)


def test_closing_from_elsewhere_ends_it():
    chain = Pipeline(FakeCamera(), finders(), objects_finder)
    with chain:
        threading.Timer(0.1, chain.close).start()
        begin = time.monotonic()
        list(chain)
        assert time.monotonic() - begin < 3.0


def test_no_thread_is_left_and_finders_are_closed():
    closed = []

    class Finder:
        def __init__(self):
            self.find = hands_finder()

        def __call__(self, frame):
            return self.find(frame)

        def close(self):
            closed.append(threading.current_thread().name)

    before = threading.active_count()
    with Pipeline(FakeCamera(), Finder, objects_finder) as chain:
        for message in chain:
            if message.t > 0.2:
                break
    assert threading.active_count() == before
    assert closed == ["igrip-camera: hands"]


def test_each_camera_has_its_own_finders():
    made = []

    def new():
        made.append(1)
        return hands_finder()

    chain = Pipeline(FakeCamera(count=10, cameras=("a", "b")), new, None)
    with chain:
        list(chain)
    assert len(made) == 2
    assert set(chain.pictures()) == {"a", "b"}
    assert {"a: hands", "b: hands"} <= set(chain.report())
