"""Measure the hand detector on real pictures: hits, misses, false detections and time.

``python -m benchmarks.measure_hands FOLDER`` with the folder of ``hand_720p.mp4``,
``experiment_side_a.png``, ``experiment_side_b.png`` and ``ycbv_000629_rgb.png``. Prints the tables
of docs/hands.md; times are of one core.
"""

from __future__ import annotations

import itertools
import os
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.film_sprites import film_sprites
from igrip.lab.rendering.drawn_hand import draw_hand, paste_hand
from igrip.perception.hands import PALM, HandDetection, palm_length
from igrip.perception.hands._image_tiles import paint_over
from igrip.perception.hands.mediapipe import MediaPipeConfig, MediaPipeHands
from igrip.rgbd import Intrinsics, RgbdFrame

Picture = NDArray[np.uint8]
RATE = 30.0
# palms of the two hands in the pictures, marked by hand [pixels]
IMAGES = {
    "experiment_side_a.png": ((135, 315), (203, 360)),
    "experiment_side_b.png": ((655, 345), (582, 395)),
}


def read_video(path: Path) -> Iterator[Picture]:
    """Yield the pictures of a film."""
    film = cv2.VideoCapture(str(path))
    while True:
        good, picture = film.read()
        if not good:
            return
        yield cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)


def read_image(path: Path) -> Picture:
    """Return one picture."""
    picture: Picture = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
    return picture


def detect_in(
    pictures: Iterable[Picture], config: MediaPipeConfig
) -> tuple[list[list[HandDetection]], NDArray[np.float64]]:
    """Return what is found in each picture, and how long each took [ms]."""
    detector = MediaPipeHands(config)
    found, took = [], []
    for k, picture in enumerate(pictures):
        height, width = picture.shape[:2]
        camera = Intrinsics(width, height, width, width, width / 2, height / 2)
        begin = time.process_time()  # wall time would depend on the load
        found.append(detector.detect(RgbdFrame(k / RATE, picture, None, camera)))
        took.append(1e3 * (time.process_time() - begin))
    detector.close()
    return found, np.array(took)


def print_counts(name: str, found: list[list[HandDetection]], took: NDArray[np.float64]) -> None:
    """Print how many frames had how many hands, and the times."""
    counts = np.bincount([len(hands) for hands in found])
    p50, p90, p99 = np.percentile(took, [50, 90, 99])
    times = f"{p50:.1f} / {p90:.1f} / {p99:.1f} ms of a core"
    print(f"{name:44} hands {dict(enumerate(counts.tolist()))}  {times}")


def with_mirror_image(picture: Picture) -> Picture:
    """Return a picture of 1280 × 720: the scene and its mirror image, side by side."""
    half = cv2.resize(picture, (640, 360), interpolation=cv2.INTER_AREA)
    both: Picture = cv2.copyMakeBorder(
        np.hstack([half, half[:, ::-1]]), 180, 180, 0, 0, cv2.BORDER_REPLICATE
    )
    return both


def measure_video(path: Path) -> None:
    """Measure on a video: one hand, two hands, and a hand that is hidden at times."""
    frames = list(read_video(path))
    found, took = detect_in(frames, MediaPipeConfig())
    print_counts("film, one hand, up to two looked for", found, took)
    labels = [hands[0].label for hands in found if hands]
    flips = sum(a != b for a, b in itertools.pairwise(labels))
    print(f"  found in {np.mean([len(h) > 0 for h in found]):.2%}; labels flip {flips} times")
    off = np.array([
        np.diff([hands[0].landmarks[list(PALM)].mean(axis=0) for hands in found[k : k + 3]], 2, 0)
        / palm_length(found[k + 1][0].landmarks)
        for k in range(len(found) - 2)
        if all(found[k : k + 3])
    ])  # fmt: skip
    jitter = 1.4826 * np.median(np.abs(off)) / np.sqrt(6)
    print(f"  the palm centre jitters by {jitter:.4f} lengths of the palm, frame by frame")
    print_counts("film, up to one looked for", *detect_in(frames, MediaPipeConfig(max_hands=1)))
    print_counts(
        "film and its mirror image, two hands",
        *detect_in(map(with_mirror_image, frames), MediaPipeConfig()),
    )
    print_counts(
        "film, searched every frame for a second",
        *detect_in(frames, MediaPipeConfig(search_every=1)),
    )
    dark = np.zeros_like(frames[0])
    found, _ = detect_in(
        (dark if k % 60 < 15 else p for k, p in enumerate(frames)), MediaPipeConfig()
    )
    back = [
        next((n for n in range(45) if k + n < len(found) and found[k + n]), 45)
        for k in range(15, len(found) - 1, 60)
    ]
    ghosts = sum(len(hands) for k, hands in enumerate(found) if k % 60 < 15)
    print(f"  hidden for 0.5 s, found anew after {back} frames; {ghosts} found where none was")


def is_hand_at(hands: list[HandDetection], palm: NDArray[np.float64], within: float) -> bool:
    """Whether a hand was found at a place."""
    centres = [hand.landmarks[list(PALM)].mean(axis=0) for hand in hands]
    return any(np.linalg.norm(centre - palm) < within for centre in centres)


def measure_images(folder: Path) -> None:
    """Measure on pictures of clasped hands, shown for 3 s, as they are and in 15 variants."""
    for name, palms in IMAGES.items():
        picture = read_image(folder / name)
        rng = np.random.default_rng(1)
        first, held, extra = [], [], 0
        for variant in range(16):
            scale = rng.uniform(0.8, 2.0) if variant else 1.0
            light = rng.uniform(0.7, 1.2) if variant else 1.0
            variant_picture = cv2.convertScaleAbs(
                cv2.resize(picture, None, fx=scale, fy=scale), alpha=light
            )
            found, _ = detect_in([variant_picture] * 90, MediaPipeConfig())
            all_there = [
                [is_hand_at(hands, scale * np.array(palm), 40 * scale) for palm in palms]
                for hands in found
            ]
            done = [all(pair) for pair in all_there]
            first.append(done.index(True) if any(done) else None)
            held.append(np.mean(all_there[-30:], axis=0).round(2).tolist())
            extra += sum(len(hands) - sum(p) for hands, p in zip(found, all_there, strict=True))
            if not variant:
                print(f"{name}: both from frame {first[0]} on, each in the last second {held[0]}")
        times = sum(f is not None for f in first)
        print(f"  variants: both found in {times} of 16; from frame {first}; {extra} wrong finds")


def measure_false_detections(folder: Path) -> None:
    """Count detections in pictures without hands, searched in every frame."""
    for name in ("ycbv_000629_rgb.png", *IMAGES):
        picture = read_image(folder / name)
        if name in IMAGES:
            found, _ = detect_in([picture] * 60, MediaPipeConfig(search_every=1))
            hands = max(found, key=len)
            picture = paint_over(picture, [hand.landmarks for hand in hands])
        found, took = detect_in([picture] * 60, MediaPipeConfig(search_every=1))
        print_counts(f"{name}, hands covered", found, took)


def measure_pasted_hands(folder: Path) -> None:
    """Measure on hands pasted into single pictures, with MediaPipe alone.

    Prints for a plain desk and a cluttered one, near and far, as they are and 1.4 times as bright,
    how many of 24 are found, and how far off the palm centre is.
    """
    detector = MediaPipeHands(MediaPipeConfig(max_hands=1, tiles=0))
    real = list(film_sprites(folder / "hand_720p.mp4", detector, every=60))
    drawn = [draw_hand(seed=k) for k in range(3)]
    camera = Intrinsics(640, 480, 450.0, 450.0, 320.0, 240.0)
    rng, clock = (
        np.random.default_rng(0),
        itertools.count(1000, -1),
    )  # backwards, so that nothing is tracked
    plain = np.full((480, 640, 3), (190.0, 180.0, 165.0)) + rng.normal(0.0, 4.0, (480, 640, 3))
    desks = {
        "plain": plain.astype(np.uint8),
        "cluttered": read_image(folder / "ycbv_000629_rgb.png"),
    }
    for desk, (low, high), light in itertools.product(desks, ((0.3, 0.5), (0.5, 0.9)), (1.0, 1.4)):
        results = []
        for name, sprites in (("film", real), ("drawn", drawn)):
            off = []
            for k in range(24):
                at = tuple(rng.uniform([150, 150], [490, 330]))
                depth, turn = rng.uniform(low, high), rng.uniform(-3.1, 3.1)
                empty = RgbdFrame(float(next(clock)), desks[desk], None, camera)
                frame, truth = paste_hand(empty, sprites[k % len(sprites)], at, depth, turn, light)
                for hand in detector.detect(frame):
                    gap = hand.landmarks[list(PALM)].mean(0) - truth[list(PALM)].mean(0)
                    off.append(np.linalg.norm(gap) / palm_length(truth))
            middle = np.median(off) if off else np.nan
            results.append(f"{name} {sum(x < 0.3 for x in off)} of 24, off by {middle:.3f}")
        print(
            f"{desk:10} {low} to {high} m, light {light}: {'; '.join(results)} lengths of the palm"
        )
    detector.close()


if __name__ == "__main__":
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    cv2.setNumThreads(1)
    data = Path(sys.argv[1])
    measure_video(data / "hand_720p.mp4")
    measure_images(data)
    measure_false_detections(data)
    measure_pasted_hands(data)
