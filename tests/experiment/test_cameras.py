"""Cameras of a study: what they see is named, kept while a trial goes on, and missed when gone."""

from __future__ import annotations

import urllib.error
import urllib.request
from contextlib import closing

import pytest

from igrip.errors import CameraError
from igrip.experiment.cameras import MAX_AGE, CameraRecorder, TappedCamera
from igrip.experiment.conductor import Conductor
from igrip.experiment.plan import draw_plan
from igrip.experiment.screens import Screens
from igrip.experiment.session import Session
from igrip.experiment.study import StudyError, read_instructions
from igrip.io.recordings import open_source
from live_fakes import Clock as FrameClock
from live_fakes import FakeCamera, frame
from runtime_fakes import PATIENCE, Clock, until
from small_study import FakeObserver, FakeRecorder, observation, small_study


class Setup:
    def __init__(self, path):
        self.study = small_study(path).study
        self.observers = {"left": FakeObserver(), "right": FakeObserver()}
        self.clock = Clock(5.0)
        self.recorder = CameraRecorder(self.study, self.observers, clock=self.clock)
        self.trial = draw_plan(self.study, "P01").trials[0]
        self.files = {name: path / f"{name}.mcap" for name in self.observers}

    def both(self, t):
        for camera, observer in self.observers.items():
            before = self.recorder._one[camera]._t
            observer.put(observation(t))
            until(lambda c=camera, b=before: self.recorder._one[c]._t != b)


@pytest.fixture
def setup(tmp_path):
    one = Setup(tmp_path / "study")
    yield one
    one.recorder.close()


def test_only_what_is_measured_between_start_and_stop_is_kept(setup):
    setup.both(1.0)
    setup.recorder.start(setup.trial, 1, setup.files)
    setup.both(2.0)
    setup.recorder.mark("trial", trial=1)
    setup.both(3.0)
    setup.recorder.stop()
    setup.both(4.0)
    for path in setup.files.values():
        kept = list(open_source(path))
        assert [one.t for one in kept] == [2.0, 3.0]
        assert kept[0].objects["soup"].model == "005_tomato_soup_can"
        assert kept[0].hands["right"].position == (0.1, 0.2, 2.0)


def test_what_is_seen_is_told_for_each_camera_and_forgotten(setup):
    assert not any(setup.recorder.seen().values())
    setup.both(1.0)
    seen = {name for name, is_seen in setup.recorder.seen().items() if is_seen}
    assert seen == {
        f"{camera} camera: {name}"
        for camera in ("left", "right")
        for name in ("right hand", "soup")
    }
    setup.clock.t += 1.1 * MAX_AGE
    assert not any(setup.recorder.seen().values())


def test_a_camera_that_vanishes_is_named_and_no_trial_starts(setup):
    setup.recorder.start(setup.trial, 1, setup.files)
    setup.observers["right"].put(CameraError("unplugged"))
    until(lambda: setup.recorder.failure() is not None)
    assert setup.recorder.failure() == "camera right: unplugged"
    with pytest.raises(CameraError, match="camera right: unplugged"):
        setup.recorder.stop()
    with pytest.raises(CameraError, match=r"camera right.*same command again"):
        setup.recorder.start(setup.trial, 2, setup.files)


def test_a_camera_without_an_address_is_named(tmp_path):
    study = small_study(tmp_path / "study").study
    with pytest.raises(StudyError, match="--camera right="):
        CameraRecorder(study, {"left": FakeObserver()})


def test_frames_are_kept_too_on_the_clock_of_the_observations(tmp_path):
    setup = Setup(tmp_path / "study")
    setup.observers["left"].begin = 100.0
    tap = TappedCamera(FakeCamera(FrameClock(), count=0))
    setup.recorder._taps = {"left": tap}
    setup.recorder.start(setup.trial, 1, setup.files)
    for k in range(3):
        tap.tap(frame(101.0 + k))
    setup.recorder.stop()
    assert tap.tap is None
    from igrip.io.mcap.reader import McapReader

    assert [one.t for one in McapReader(setup.files["left"]).frames()] == [1.0, 2.0, 3.0]
    setup.recorder.close()


def test_the_newest_picture_is_shown(tmp_path):
    setup = Setup(tmp_path / "study")
    tap = TappedCamera(FakeCamera(FrameClock(), count=2))
    setup.recorder._taps = {"left": tap}
    assert setup.recorder.picture("left") is None
    assert len(list(tap)) == 2
    assert setup.recorder.picture("left").startswith(b"\xff\xd8\xff")
    assert setup.recorder.picture("right") is None
    setup.recorder.close()


def test_the_page_serves_what_a_camera_sees(tmp_path):
    folder = small_study(tmp_path / "study")
    session = Session(folder, folder.enrol("P01", "2026-01-31"), FakeRecorder())
    conductor = Conductor(session, read_instructions(folder.path, "en"), dict)
    seen = {"left": b"\xff\xd8\xffpicture"}
    with closing(Screens(conductor, {}, seen.get, 0)) as screens, closing(session):
        with urllib.request.urlopen(f"{screens.url}/camera/left", timeout=PATIENCE) as answer:
            assert (answer.headers["Content-Type"], answer.read()) == ("image/jpeg", seen["left"])
        for path in ("camera/right", "camera/other", "camera"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(f"{screens.url}/{path}", timeout=PATIENCE)
