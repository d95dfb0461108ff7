"""From pixels to intentions on rendered reaches, beside the same reaches with true positions.

Example: python docs/measure_live.py ../shared/data/images/hand_720p.mp4 --reaches 40
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import igrip
from igrip.entities import Hand, ObjectPose
from igrip.live.eyes import hand_eye, object_eye
from igrip.live.merge import HandsFound, ObjectsFound
from igrip.live.offline import observe
from igrip.observation import Observation
from igrip.objects.catalog import PAPER_OBJECTS
from igrip.rgbd import RgbdFrame
from igrip.simulation.filmed import MIDDLE, FilmedReach, film_reach
from igrip.simulation.sprites import Sprite, film_sprites, place
from igrip.vision.hands.mediapipe import MediaPipeHands
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
NOISE = 0.004  # m; of a true position that is told instead
EVERY = 3  # frames between two looks at objects


def sprites(film: Path) -> list[Sprite]:
    """Return some hands of a film."""
    finder = MediaPipeHands()
    try:
        return list(film_sprites(film, finder, every=60))
    finally:
        finder.close()


def true_observations(film: FilmedReach, seed: int) -> Iterator[Observation]:
    """Tell a reach by true positions and noise, at the same times as a live chain would."""
    random = np.random.default_rng(seed)
    poses = {}
    for id, placed in film.scene.objects.items():
        x, y, z, w = Rotation.from_matrix(placed.pose[:3, :3]).as_quat().tolist()
        poses[id] = ObjectPose(
            position=tuple(placed.pose[:3, 3].tolist()), orientation=(x, y, z, w), model=id
        )
    palms = iter(film.done.palms[film.task.hand] - MIDDLE)

    def hands(frame: RgbdFrame) -> HandsFound:
        told = next(palms) + random.normal(0.0, NOISE, 3)
        return HandsFound(frame, {film.task.hand: Hand(position=tuple(told.tolist()))}, {})

    frames = (
        RgbdFrame(t, np.zeros((1, 1, 3), np.uint8), None, film.scene.intrinsics)
        for t in film.done.times.tolist()
    )
    yield from observe(frames, hands, lambda frame, _: ObjectsFound(frame, poses), EVERY)


def judged(catalog, film: FilmedReach, messages: Iterator[Observation], hand: str | None):
    """Return whether the target is right 0.3 s before the end, and at the end; palms' errors."""
    estimator = igrip.Estimator(catalog)
    onset, end = film.done.bounds
    right: list[tuple[float, bool]] = []
    errors = []
    world = film.done.palms[film.task.hand] - MIDDLE
    for message in messages:
        for id, told in message.hands.items():
            if told is not None:
                k = int(np.argmin(np.abs(film.done.times - told.t)))
                errors.append(np.linalg.norm(np.array(told.position) - world[k]))
        for said in estimator.update(message):
            if said.target is not None and onset <= message.t <= end + 0.1:
                right.append((message.t, said.target == film.task.target))
    late = [good for t, good in right if t >= end - 0.3]
    return {
        "answers": len(right), "at_end": bool(right and right[-1][1]),
        "late": float(np.mean(late)) if late else 0.0, "errors": errors,
        "success": bool(right) and sum(g for _, g in right if True) > 0 and right[-1][1],
    }  # fmt: skip


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("film", type=Path, help="a film of one hand, to cut hands from")
    parser.add_argument("--reaches", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    catalog = igrip.load_objects("ycb")
    cut = sprites(asked.film)
    new_hands, new_objects = hand_eye("mediapipe", 2), None
    rows = []
    took: list[tuple[float, float]] = []
    for number in range(asked.reaches):
        film = film_reach(catalog, 1000 * asked.seed + number)
        sprite = cut[number % len(cut)]
        new_objects = object_eye("depth", catalog, {"models": PAPER_OBJECTS})

        def put(frame: RgbdFrame, side: str, palm: Array) -> RgbdFrame:
            pixel = frame.intrinsics.pixels(palm[None])[0]
            return place(frame, sprite, (float(pixel[0]), float(pixel[1])), float(palm[2]), np.pi)[0]

        begin = time.perf_counter()
        seen = judged(catalog, film, observe(film.frames(put), new_hands(), new_objects(), EVERY), None)
        took.append((time.perf_counter() - begin, len(film.done.times)))
        true = judged(catalog, film, true_observations(film, number), film.task.hand)
        rows.append((seen, true))
        error = np.median(seen["errors"]) if seen["errors"] else np.nan
        print(
            f"{number:3d} {film.task.target:22s} pixels: {len(seen['errors']):3d} of "
            f"{len(film.done.times)} frames measured, off {1e3 * error:5.1f} mm, "
            f"right {seen['at_end']!s:5}  true positions: right {true['at_end']!s:5}",
            flush=True,
        )
    for name, k in (("pixels", 0), ("true positions + noise", 1)):
        print(f"{name}: right at the end {100 * np.mean([r[k]['at_end'] for r in rows]):.1f} %, "
              f"in the last 0.3 s {100 * np.mean([r[k]['late'] for r in rows]):.1f} %")
    print(f"load average {os.getloadavg()[0]:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
