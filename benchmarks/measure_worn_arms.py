"""Measure hands by depth on rendered arms that wear something.

``python -m benchmarks.measure_worn_arms`` prints the table of docs/hands.md: of each kind of arm,
before cameras at three places, how often the palm is measured, and how far off. With
``--film FILE`` also on hands cut out of a film and put, painted over, before a table.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.film_sprites import film_sprites
from benchmarks.worn_arms import KINDS, ArmPose, reach, table_before
from igrip.lab.rendering.drawn_hand import PALM, Sprite, paste_hand
from igrip.perception.hands.depth import DepthHands
from igrip.perception.hands.mediapipe import MediaPipeHands
from igrip.rgbd import RgbdFrame

RATE = 30.0
VIEWS = ((0.0, 40.0), (35.0, 40.0), (180.0, 60.0))  # azimuth, elevation [degrees]
EDGE = -0.34  # y of the palm from which on a hand is over the table whole [m]
WITHIN = 0.025  # m


class Result(NamedTuple):
    """How far off palms were [m], of how many frames with a hand, and hands that are none."""

    off: NDArray[np.float64]
    frames: int
    extra: int

    def row(self) -> str:
        """Return the cells of a table."""
        if not len(self.off):
            return f"never | | | {self.extra}"
        share = (self.off < WITHIN).sum() / self.frames
        p50, p95 = 1e3 * np.percentile(self.off, [50, 95])
        return f"{share:.0%} | {p50:.0f} / {p95:.0f} mm | {self.extra}"


def judge(frames: list[tuple[RgbdFrame, NDArray[np.float64] | None, bool]]) -> Result:
    """Return how hands by depth agree with where the palm is, world frame, or is not (None).

    A frame with a palm counts if the last of the three says so.
    """
    detector = DepthHands()
    off, count, extra = [], 0, 0
    for frame, palm, counts in frames:
        found = [np.array(hand.measured.position) for hand in detector.detect(frame)
                 if hand.measured is not None]  # fmt: skip
        if palm is None or not counts:
            extra += len(found) if palm is None else max(0, len(found) - 1)
            continue
        count += 1
        extra += max(0, len(found) - 1)
        if found:
            off.append(min(float(np.linalg.norm(one - palm)) for one in found))
    return Result(np.array(off), count, extra)


def rendered(kind: str, view: tuple[float, float], frames: int) -> Result:
    """Let an arm come in, rest, and reach."""
    film = table_before(*view)
    poses: list[ArmPose | None] = [None] * 5
    poses += reach((0.2, -0.55, 0.08), (0.2, -0.25, 0.05), (0.3, -0.85, 0.15), 8)
    poses += reach((0.2, -0.25, 0.05), (-0.15, 0.0, 0.1), (0.3, -0.85, 0.15), frames, 3)
    seen = []
    for k, pose in enumerate(poses):
        frame = film.frame((k + 1) / RATE, {} if pose is None else {"arm": (kind, pose)})
        seen.append((frame, None if pose is None else pose.palm,
                     pose is not None and bool(pose.palm[1] >= EDGE)))  # fmt: skip
    return judge(seen)


def filmed(sprites: list[Sprite]) -> Result:
    """Move hands of a film, grey all over, before a table seen from above."""
    film = table_before(0.0, 75.0, 1.0)
    empty = [film.frame(k / RATE, {}) for k in range(5)]
    seen: list[tuple[RgbdFrame, NDArray[np.float64] | None, bool]] = [
        (frame, None, False) for frame in empty
    ]
    for k, sprite in enumerate(sprites):
        blank = sprite._replace(colour=np.full_like(sprite.colour, 90))
        base = empty[k % len(empty)]
        t = (k + 5) / RATE
        turn = 2.9 + 0.25 * np.sin(0.1 * k)
        at = (320.0 + 60.0 * np.sin(0.07 * k), 150.0 + 40.0 * np.cos(0.05 * k))
        moved = RgbdFrame(t, base.colour, base.depth, base.intrinsics, base.camera,
                          base.world_from_camera)  # fmt: skip
        frame, landmarks = paste_hand(moved, blank, at, 0.85, turn)
        pixel = landmarks[list(PALM)].mean(axis=0)[None]
        palm = frame.intrinsics.points(pixel, np.array([0.85]))[0]
        world = frame.world_from_camera
        seen.append((frame, world[:3, :3] @ palm + world[:3, 3], True))
    return judge(seen)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--film", type=Path, help="a film of one hand, such as hand_720p.mp4")
    parser.add_argument("--frames", type=int, default=14, help="of a reach")
    asked = parser.parse_args()
    began = time.perf_counter()
    print("| arm | camera | within 25 mm | off, p50 / p95 | hands too many |")
    print("| --- | --- | --- | --- | --- |")
    every, frames, extra = [], 0, 0
    for kind in KINDS:
        for view in VIEWS:
            result = rendered(kind, view, asked.frames)
            every.append(result.off)
            frames += result.frames
            extra += result.extra
            print(f"| {kind} | {view[0]:.0f}° | {result.row()} |", flush=True)
    total = Result(np.concatenate(every), frames, extra)
    print(f"| all | | {total.row()} |")
    if asked.film is not None:
        detector = MediaPipeHands()
        sprites = list(film_sprites(asked.film, detector, every=3))
        detector.close()
        print(f"| film, painted over | above | {filmed(sprites).row()} |")
    print(f"{time.perf_counter() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
