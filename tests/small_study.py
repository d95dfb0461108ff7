"""A small study for the tests, with a recorder and an observer that do what they are told."""

from __future__ import annotations

import queue
import re

from igrip.entities import Hand, ObjectPose
from igrip.errors import RecordingError
from igrip.experiment.folder import StudyFolder, new_study
from igrip.observation import Observation


def small_study(path, **changes):
    """Write the small template with some lines changed; return its folder."""
    new_study(path, "small")
    file = path / "study.toml"
    text = file.read_text()
    for old, new in changes.items():
        assert f"{old} = " in text
        text = re.sub(f"^{old} = .*$", f"{old} = {new}", text, flags=re.MULTILINE)
    file.write_text(text)
    return StudyFolder(path)


class FakeRecorder:
    """Writes the trial and the attempt into each file; fails when told to."""

    def __init__(self):
        self.open, self.fails, self.lost = {}, None, {}
        self.failed = None

    def seen(self):
        return {"left": True, "right": True, "soup": True} | self.lost

    def picture(self, camera):
        return None

    def start(self, trial, attempt, files):
        if self.fails == "start":
            raise RecordingError("camera left: no device")
        for camera, path in files.items():
            self.open[camera] = path
            path.write_text(f"{trial.number} {attempt} {camera}\n")

    def mark(self, name, **data):
        pass

    def failure(self):
        return self.failed

    def stop(self):
        if self.fails == "stop":
            raise RecordingError("camera right: unplugged")
        self.open = {}

    def close(self):
        pass


class FakeObserver:
    """Yields what the test puts; raises what it puts that is an error."""

    def __init__(self):
        self.begin = 0.0
        self.queue = queue.SimpleQueue()

    def put(self, one):
        self.queue.put(one)

    def __iter__(self):
        while (one := self.queue.get()) is not None:
            if isinstance(one, Exception):
                raise one
            yield one

    def close(self):
        self.queue.put(None)


def observation(t, model="005_tomato_soup_can"):
    return Observation(
        t=t, hands={"right": Hand(position=(0.1, 0.2, t)), "left": None},
        objects={"object_7": ObjectPose(position=(0, 0.4, 0), orientation=(0, 0, 0, 1),
                                        model=model)},
    )  # fmt: skip
