"""From pixels to intentions on rendered reaches, beside the same reaches with true positions.

Example: python -m benchmarks.measure_live hand.mp4 --reaches 40
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import igrip
from benchmarks.film_sprites import film_sprites
from igrip.entities import Hand, ObjectPose
from igrip.lab.rendering.drawn_hand import Sprite, paste_hand
from igrip.lab.rendering.filmed_reach import MIDDLE, FilmedReach, film_reach
from igrip.lab.rendering.layout import PlacedMesh
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.observation import Observation
from igrip.perception.hands.mediapipe import MediaPipeHands
from igrip.perception.pipeline.merge import DetectedHands, DetectedObjects
from igrip.perception.pipeline.stages import hand_stages, object_stages
from igrip.perception.pipeline.synchronous import observe
from igrip.rgbd import RgbdFrame

Array = NDArray[np.float64]
NOISE = 0.004  # m, each axis, of the true positions
SAME = 0.05  # m; an unknown thing is what stands so near
EVERY = 3  # frames from one look at objects to the next


def cut_hands(film: Path) -> list[Sprite]:
    """Return some hands of a film."""
    detector = MediaPipeHands()
    try:
        return list(film_sprites(film, detector, every=60))
    finally:
        detector.close()


def put_hand(sprite: Sprite, frame: RgbdFrame, side: str, palm: Array) -> RgbdFrame:
    """Put a hand into a frame, fingers towards the camera."""
    x, y = frame.intrinsics.pixels(palm[None])[0].tolist()
    return paste_hand(frame, sprite, (x, y), float(palm[2]), np.pi)[0]


def true_observations(film: FilmedReach, seed: int) -> Iterator[Observation]:
    """Yield a reach by true positions and noise, when a live pipeline would."""
    random = np.random.default_rng(seed)
    poses = {}
    for id, placed in film.scene.objects.items():
        x, y, z, w = Rotation.from_matrix(placed.pose[:3, :3]).as_quat().tolist()
        a, b, c = placed.pose[:3, 3].tolist()
        poses[id] = ObjectPose(position=(a, b, c), orientation=(x, y, z, w), model=id)
    palms = iter(film.done.palms[film.task.hand] - MIDDLE)

    def hands(frame: RgbdFrame) -> DetectedHands:
        x, y, z = (next(palms) + random.normal(0.0, NOISE, 3)).tolist()
        return DetectedHands(frame, {film.task.hand: Hand(position=(x, y, z))}, {})

    nothing = np.zeros((1, 1, 3), np.uint8)
    frames = [RgbdFrame(t, nothing, None, film.scene.intrinsics) for t in film.done.times.tolist()]
    return observe(frames, hands, lambda frame, _: DetectedObjects(frame, poses), EVERY)


def true_id(film: FilmedReach, catalog: Catalog, id: str, pose: ObjectPose) -> str:
    """Return which of the objects an id means: by name, or, of an unknown thing, by place."""
    if id in film.scene.objects:
        return id
    model = catalog[pose.model or id]
    at = (
        np.array(pose.position)
        + Rotation.from_quat(pose.orientation).as_matrix() @ (model.sphere[:3])
    )
    middles = {
        name: (placed.pose @ [*placed.model.sphere[:3], 1.0])[:3]
        for name, placed in film.scene.objects.items()
    }
    near = min(middles, key=lambda name: float(np.linalg.norm(middles[name] - at)))
    return near if np.linalg.norm(middles[near] - at) < SAME else id


def judge(catalog: Catalog, film: FilmedReach, messages: Iterator[Observation]) -> dict[str, Any]:
    """Return whether the target is right in the longest run of predictions, and palm errors.

    Success is the paper's: the object that was named without a break for longest, from the onset to
    the end of the movement.
    """
    estimator = igrip.Estimator(catalog)
    onset, end = film.done.bounds
    named: list[str | None] = []
    off, offs = [], {}
    meant: dict[str, str] = {}
    world = film.done.palms[film.task.hand] - MIDDLE
    for message in messages:
        for hand in message.hands.values():
            if hand is not None:
                measured = message.t if hand.t is None else hand.t
                k = int(np.argmin(np.abs(film.done.times - measured)))
                off.append(float(np.linalg.norm(np.array(hand.position) - world[k])))
        for id, pose in message.objects.items():
            if pose is not None:
                meant[id] = true_id(film, catalog, id, pose)
                if meant[id] == id and id in film.scene.objects:
                    offs[id] = _apart(film.scene.objects[id], pose)
        for intention in estimator.update(message):
            if onset <= message.t <= end:
                target = intention.target
                named.append(None if target is None else meant.get(target, target))
    runs: list[tuple[int, str | None]] = []
    for name in named:
        runs.append((runs[-1][0] + 1 if runs and runs[-1][1] == name else 1, name))
    longest = max((run for run in runs if run[1] is not None), default=(0, None))
    return {
        "success": longest[1] == film.task.target,
        "at_end": bool(named) and named[-1] == film.task.target,
        "off": off, "objects_off": offs, "others": len(set(meant.values()) - set(
            film.scene.objects)),
    }  # fmt: skip


def _apart(placed: PlacedMesh, pose: ObjectPose) -> float:
    """Return how far the middle of an object is off [m]: its origin may lie outside it."""
    middle = placed.model.sphere[:3]
    true = placed.pose[:3, :3] @ middle + placed.pose[:3, 3]
    estimate = Rotation.from_quat(pose.orientation).as_matrix() @ middle + np.array(pose.position)
    return float(np.linalg.norm(true - estimate))


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("film", type=Path, help="a film of one hand, to cut hands from")
    parser.add_argument("--reaches", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--poses", default="depth", help="pose estimator; of shapes, nothing is known"
    )
    asked = parser.parse_args()
    catalog = igrip.load_objects("ycb")
    hands = cut_hands(asked.film)
    new_hands = hand_stages("mediapipe", 2)
    rows, frames, began = [], 0, time.perf_counter()
    for number in range(asked.reaches):
        film = film_reach(catalog, 1000 * asked.seed + number)
        objects = object_stages(asked.poses, catalog, {"models": PAPER_OBJECTS})()
        put = partial(put_hand, hands[number % len(hands)])
        detect = new_hands()
        result = judge(catalog, film, observe(film.frames(put), detect, objects, EVERY))
        detect.close()
        true = judge(catalog, film, true_observations(film, number))
        rows.append((result, true))
        frames += len(film.done.times)
        palm = 1e3 * float(np.median(result["off"])) if result["off"] else float("nan")
        worst = 1e3 * max(result["objects_off"].values(), default=float("nan"))
        print(
            f"{number:3d} {film.task.target:22s} palm in {len(result['off'])} of "
            f"{len(film.done.times)} frames, off {palm:.1f} mm; {len(result['objects_off'])} "
            f"objects, off by at most {worst:.1f} mm; {'right' if result['success'] else 'WRONG'}"
            f" (true positions: {'right' if true['success'] else 'WRONG'})",
            flush=True,
        )
    for k, name in enumerate(("from pixels", "true positions and noise")):
        success, at_end = (100.0 * np.mean([row[k][key] for row in rows])
                           for key in ("success", "at_end"))  # fmt: skip
        print(f"{name}: target right in {success:.1f} % of trials, at the end in {at_end:.1f} %")
    share = sum(len(row[0]["off"]) for row in rows) / frames
    every = np.concatenate([row[0]["off"] for row in rows])
    print(
        f"palms measured in {100.0 * share:.1f} % of {frames} frames, off by "
        f"{1e3 * np.median(every):.1f} mm (median), {1e3 * np.quantile(every, 0.95):.1f} (95 %)"
    )
    invented = sum(row[0]["others"] for row in rows)
    if invented:
        print(f"{invented} things that are none")
    print(f"{time.perf_counter() - began:.0f} s, load average {os.getloadavg()[0]:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
