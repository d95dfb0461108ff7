"""Playback: the position in a recording, and the controls on the page."""

from __future__ import annotations

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from browser import needs_chromium
from igrip import Config, Estimator
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.lab.simulation.demo import DemoPerson
from igrip.viewer.playback import Player, Playhead, ReplayWorker, replay_snapshots
from igrip.viewer.server import Viewer

pytest.importorskip("websockets", reason="the extra 'viewer' is not installed")
TIMES = st.lists(st.floats(0.0, 100.0), min_size=1, max_size=20, unique=True).map(sorted)


def test_by_hand():
    head = Playhead([0.0, 0.1, 0.2, 0.4])
    head.tick(1.0)
    assert head.index == 0  # it does not run yet
    head.play()
    head.tick(0.15)
    assert head.index == 1
    head.tick(0.15)
    assert head.index == 2
    head.speed = 0.5
    head.tick(0.1)
    assert head.index == 2  # at 0.35
    head.tick(5.0)
    assert (head.index, head.playing) == (3, False)
    head.play()  # again from the beginning
    assert (head.index, head.playing) == (0, True)
    head.step(2)
    assert (head.index, head.playing) == (2, False)
    head.step(-10)
    assert head.index == 0
    head.seek(0.39)
    assert head.index == 2
    head.seek(-3.0)
    assert head.index == 0


@given(TIMES, st.lists(st.floats(-1.0, 101.0), max_size=10))
def test_it_stands_at_the_last_moment_not_later_than_the_time_sought(times, sought):
    head = Playhead(times)
    for t in sought:
        head.seek(t)
        clipped = min(max(t, times[0]), times[-1])
        assert head.index == max(k for k, own in enumerate(times) if own <= clipped)


@given(TIMES, st.lists(st.floats(0.0, 5.0), max_size=30))
def test_playing_reaches_the_end_and_never_goes_back(times, steps):
    head = Playhead(times)
    head.play()
    before = head.index
    for dt in [*steps, 200.0]:
        head.tick(dt)
        assert head.index >= before
        before = head.index
    assert head.index == len(times) - 1
    assert not head.playing


@pytest.fixture(scope="module")
def recording(ycb, tmp_path_factory):
    path = tmp_path_factory.mktemp("playback") / "demo.jsonl"
    with JsonlWriter(path) as writer:
        for moment in DemoPerson(ycb, 0):
            if moment.observation.t > 4.0:
                break
            writer.write(moment.observation)
    return path


def test_a_replay_holds_the_intentions_of_the_estimator(recording, ycb):
    snapshots = replay_snapshots(JsonlReader(recording), ycb, Config(targets="paper"))
    estimator = Estimator(ycb, Config(targets="paper"))
    said = [estimator.update(observation) for observation in JsonlReader(recording)]
    assert [
        [h.intention for h in moment.hands if h.intention.t == moment.t] for moment in snapshots
    ] == said
    later = replay_snapshots(JsonlReader(recording), ycb, Config(targets="paper"), begin=2.0)
    assert later[0].t == pytest.approx(2.0, abs=1 / 30)
    says = [[h.intention for h in moment.hands] for moment in snapshots if moment.t >= 2.0]
    assert [[h.intention for h in moment.hands] for moment in later] == says


@pytest.mark.browser
@needs_chromium
def test_playing_on_the_page(recording, ycb, chromium):
    snapshots = replay_snapshots(JsonlReader(recording), ycb, Config())
    viewer = Viewer(port=0)
    player, end = Player(viewer, snapshots), threading.Event()
    player.head.speed = 0.1  # it must not end before a slow browser has paused it
    thread = threading.Thread(target=player.run, args=(end.is_set,))
    thread.start()
    times = [moment.t for moment in snapshots]
    page = chromium.new_page()

    def wait_for(t):
        page.wait_for_function("(t) => Math.abs(igrip.store.scene?.t - t) < 1e-4", arg=t)

    def press(name):
        page.get_by_role("button", name=name, exact=True).click()

    try:
        page.goto(viewer.url)
        press("Pause")
        page.get_by_role("button", name="Play", exact=True).wait_for()
        assert times[0] < times[player.head.index] < times[-1]
        wait_for(times[player.head.index])
        for name, index in (
            ("To the beginning", 0), ("One step forward", 1), ("To the end", -1),
            ("One step back", -2),
        ):  # fmt: skip
            press(name)
            wait_for(times[index])
        page.locator("#slider").evaluate(
            "(n, t) => { n.value = t; n.dispatchEvent(new Event('input')) }", times[10]
        )
        wait_for(times[10])
        press("Play")
        page.wait_for_function("(t) => igrip.store.scene?.t > t + 1e-4", arg=times[10])
        assert player.head.playing
    finally:
        end.set()
        thread.join()
        page.close()
        viewer.close()


def test_the_estimator_that_was_requested_last_is_shown():
    begun, go_on, status = threading.Event(), threading.Event(), []

    def replay(name):
        begun.set()
        if name == "slow":
            assert go_on.wait(60)
        return [name]

    shown, done = [], threading.Event()

    def show(name, snapshots):
        shown.append((name, snapshots))
        done.set()

    worker = ReplayWorker(replay)
    worker.start(show, status.append)
    worker.request("slow")
    assert begun.wait(60)
    worker.request("other")
    worker.request("quick")
    go_on.set()
    assert done.wait(60)
    assert shown == [("quick", ["quick"])]
    assert status[:2] == ["running slow …", "running quick …"]


def test_other_snapshots_go_on_at_the_same_time(recording, ycb):
    snapshots = replay_snapshots(JsonlReader(recording), ycb, Config())
    viewer = Viewer(port=0)
    try:
        player = Player(viewer, snapshots)
        player.head.seek(2.0)
        player.head.speed = 0.25
        player.replace(replay_snapshots(JsonlReader(recording), ycb, Config(targets="distance")))
        assert snapshots[player.head.index].t == pytest.approx(2.0, abs=1 / 30)
        assert player.head.speed == 0.25
    finally:
        viewer.close()
