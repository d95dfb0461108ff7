"""Print how a search for absent models holds up the poses of tracked things.

    python -m benchmarks.measure_search --scenes 3

Four objects of the paper and two things in no list stand on a table; the models of YCB-Video
without those two are on offer, so most of them are absent. Frames come at 30 Hz; one that comes
while another is worked on is skipped, as in `igrip live`. Time is that of the processor, so that
other work on the machine does not count.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import replace

import numpy as np

import igrip
from benchmarks.measure_poses import VISIBLE, WITHIN, middle_gap, visibility
from igrip.lab.rendering.layout import LayoutConfig
from igrip.lab.rendering.scene import RenderedScene, random_scene
from igrip.objects.catalog import PAPER_OBJECTS, YCB_VIDEO, Catalog
from igrip.perception.poses.depth import DepthPoses
from igrip.rgbd import RgbdFrame

STRANGERS = ("036_wood_block", "025_mug")
RENDERED = 12  # frames with noise of their own, shown again and again


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=6.0, help="of each scene")
    parser.add_argument("--models", type=int, default=21, help="on offer")
    arguments = parser.parse_args()
    catalog = igrip.load_objects("ycb")
    others = [name for name in YCB_VIDEO if name not in (*PAPER_OBJECTS, *STRANGERS)]
    more = [name for name in catalog if name not in (*YCB_VIDEO, *STRANGERS)]
    names = [*PAPER_OBJECTS, *others, *more][: arguments.models]
    estimator = DepthPoses(catalog, {"models": names})
    firsts, rates, longest, worked = [], [], [], []
    wrong = 0
    for number, seed in enumerate(range(arguments.seed, arguments.seed + arguments.scenes)):
        frames, judged = film(catalog, seed)
        if number == 0:
            estimator.estimate(frames[0][0])  # compiles
        estimator.close()
        first, rate, longest_gap, share, wrong_names = watch(estimator, frames, judged, arguments)
        firsts += first
        rates.append(rate)
        longest.append(longest_gap)
        worked.append(share)
        wrong += wrong_names
    print(f"{len(rates)} scenes, {len(names)} models on offer, {arguments.seconds:.0f} s each")
    print(f"first detection: median {np.median(firsts):.2f} s, at most {max(firsts):.2f} s, "
          f"{np.mean(np.isfinite(firsts)):.0%} of {len(firsts)} things")  # fmt: skip
    print(f"new poses of what is tracked: {np.mean(rates):.1f} Hz; longest gap "
          f"{max(longest):.2f} s; processor busy {np.mean(worked):.0%}")  # fmt: skip
    print(f"names of absent things reported: {wrong}")
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


def film(catalog: Catalog, seed: int) -> tuple[list[tuple[RgbdFrame, RenderedScene]], list[str]]:
    """Return frames with their scene, and which objects can be seen well enough."""
    random = np.random.default_rng([seed, 21])
    while True:
        try:
            scene = random_scene(
                catalog, [*PAPER_OBJECTS, *STRANGERS], random, LayoutConfig(width=0.7, depth=0.45)
            )
            break
        except ValueError:
            continue  # they did not fit
    visible = visibility(scene)
    frames = [(scene.frame(0.0, random), scene) for _ in range(RENDERED)]
    return frames, [name for name in PAPER_OBJECTS if visible[name] >= VISIBLE]


def watch(
    estimator: DepthPoses, frames: list[tuple[RgbdFrame, RenderedScene]], judged: list[str],
    arguments: argparse.Namespace,
) -> tuple[list[float], float, float, float, int]:  # fmt: skip
    """Return times of first detection [s], rate [Hz], longest gap [s], work, wrong names."""
    first = dict.fromkeys(judged, np.inf)
    done: list[float] = []  # times at which poses came [s]
    now, busy, reported = 0.0, 0.0, set()
    while now < arguments.seconds:
        shown, scene = frames[int(now * 30) % len(frames)]
        exposed = int(now * 30 + 1e-6) / 30
        begin = time.process_time()
        poses = estimator.estimate(replace(shown, t=exposed))
        took = time.process_time() - begin
        busy += took
        now += took
        done.append(now)
        for id, pose in poses.items():
            if pose is None:
                continue
            reported.add(id)
            near = id in first and middle_gap(
                scene, id, np.array(pose.position), pose.orientation
            ) <= WITHIN  # fmt: skip
            if near:
                first[id] = min(first[id], now)
        now = max(now, (int(now * 30 + 1e-6) + 1) / 30)  # the next frame
    gaps = np.diff(done)
    return (
        list(first.values()), (len(done) - 1) / (done[-1] - done[0]), float(gaps.max()), busy / now,
        len(reported - set(PAPER_OBJECTS)),
    )  # fmt: skip


if __name__ == "__main__":
    main()
