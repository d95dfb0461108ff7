"""Ten minutes of live replay at 30 Hz: memory flat, nothing queues up, no slower at the end."""

from __future__ import annotations

import itertools
import os
import time
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
from igrip.rgbd import RgbdFrame
from igrip.runtime.clock_sync import RunClock
from igrip.runtime.loop import Loop
from igrip.runtime.stream_input import StreamInput

RATE, MINUTES = 30.0, float(os.environ.get("IGRIP_SOAK_MINUTES", "10"))


class Again:
    """Frames of one reach, forth and back, again and again, as time goes by."""

    def __init__(self, frames, seconds):
        self._frames, self._seconds, self._closed = frames, seconds, False
        self.late = 0

    def __iter__(self):
        begin = time.monotonic()
        order = [*range(len(self._frames)), *reversed(range(len(self._frames)))]
        for k, number in enumerate(itertools.cycle(order)):
            wait = begin + k / RATE - time.monotonic()
            if wait > 0.0:
                time.sleep(wait)
            now = time.monotonic()
            if self._closed or now - begin > self._seconds:
                return
            one = self._frames[number]
            yield RgbdFrame(
                now, one.colour, one.depth, one.intrinsics, one.camera, one.world_from_camera
            )

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
    pipeline = Pipeline(
        Again(frames, 60.0 * MINUTES), hand_stages("mediapipe", 2),
        object_stages("depth", ycb, {"models": PAPER_OBJECTS}),
    )  # fmt: skip
    with pipeline:
        loop = Loop(
            igrip.Estimator(ycb), RunClock(pipeline.begin), {"camera": StreamInput(pipeline)}
        )
        used: list[tuple[float, float]] = []

        def measure_memory(intentions):
            now = time.monotonic()
            if not used or now - used[-1][0] > 5.0:
                used.append((now, memory()))

        with loop:
            loop.run(measure_memory)
        report = pipeline.report()
    minute = int(60.0 * min(1.0, MINUTES / 3) * RATE * 0.8)
    ages = loop.latency.ages()
    first, last = np.median(ages[90 : 90 + minute]), np.median(ages[-minute:])
    after = [mb for t, mb in used if t - used[0][0] > 60.0 * min(1.0, MINUTES / 3)]
    print(f"exposure to intention, p50 of the first and of the last minute: {1e3 * first:.1f}, "
          f"{1e3 * last:.1f} ms; p99 {1e3 * np.quantile(ages, 0.99):.1f} ms; memory "
          f"{after[0]:.1f} to {after[-1]:.1f} MB; {report}")  # fmt: skip
    assert len(ages) > 0.5 * MINUTES * 60 * RATE
    assert last <= 1.5 * first
    assert after[-1] - after[0] < 0.03 * after[0]
    assert all(stage.get("failed", 0) == 0 for stage in report.values())
