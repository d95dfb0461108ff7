"""Ten minutes of live replay at 30 Hz: memory is flat, and nothing queues up."""

from __future__ import annotations

import itertools
import os
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import igrip
from benchmarks.film_sprites import film_sprites
from igrip.lab.rendering.drawn_hand import paste_hand
from igrip.lab.rendering.filmed_reach import film_reach
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.perception.hands.mediapipe import MediaPipeHands
from igrip.perception.pipeline.pipeline import Pipeline
from igrip.perception.pipeline.stages import hand_stages, object_stages
from igrip.runtime.clock_sync import RunClock
from igrip.runtime.loop import Loop
from igrip.runtime.stream_input import StreamInput

RATE, MINUTES = 30.0, float(os.environ.get("IGRIP_SOAK_MINUTES", "10"))


class Again:
    """So many frames of one reach, forth and back, at 30 Hz or as fast as the machine can."""

    def __init__(self, frames, count):
        self._frames, self._count, self._closed = frames, count, False

    def __iter__(self):
        due = time.monotonic()
        order = itertools.cycle([*self._frames, *reversed(self._frames)])
        for one in itertools.islice(order, self._count):
            due += 1 / RATE
            time.sleep(max(0.0, due - time.monotonic()))
            if self._closed:
                return
            yield replace(one, t=time.monotonic())

    def close(self):
        self._closed = True


def memory():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read as on Linux")
def test_ten_minutes_of_replay(ycb, shared_data):
    detector = MediaPipeHands()
    sprite = next(film_sprites(shared_data / "images" / "hand_720p.mp4", detector))
    detector.close()
    film = film_reach(ycb, 5)

    def put(frame, side, palm):
        x, y = frame.intrinsics.pixels(palm[None])[0].tolist()
        return paste_hand(frame, sprite, (x, y), float(palm[2]), np.pi)[0]

    frames = list(itertools.islice(film.frames(put), 90))
    count = int(60.0 * MINUTES * RATE)
    pipeline = Pipeline(
        Again(frames, count), hand_stages("mediapipe", 2),
        object_stages("depth", ycb, {"models": PAPER_OBJECTS}),
    )  # fmt: skip
    used = []  # memory after each update [MB]
    with pipeline:
        loop = Loop(
            igrip.Estimator(ycb), RunClock(pipeline.begin), {"camera": StreamInput(pipeline)}
        )
        with loop:
            loop.run(lambda intentions: used.append(memory()))
        report = pipeline.report()
    third = len(used) // 3
    ages = 1e3 * np.array(loop.latency.ages())
    parts = [np.median(part) for part in np.array_split(ages, 3) if len(part)]
    print(f"exposure to intention, p50 in thirds of the run [ms]: {parts}; memory "
          f"{used[third]:.1f} to {used[-1]:.1f} MB; {report}")  # fmt: skip
    assert used[-1] - used[third] < 0.03 * used[third]
    stages = [report["rendered: hands"], report["rendered: objects"]]
    assert [stage["count"] + stage["skipped"] for stage in stages] == [count, count]
    assert [stage["failed"] for stage in stages] == [0, 0]
