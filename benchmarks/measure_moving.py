"""Print how well things are followed that a hand carries or pushes.

    python -m benchmarks.measure_moving --films 8

One of the paper's four objects is carried 0.36 m through the air or pushed over the table, by a
hand beside it, while two others stand there; a rendered camera sees it with an OAK-D's noise.
The hand's landmarks are those of the former frame, as in `igrip live`. Judged are the frames in
which the thing moves.
"""

from __future__ import annotations

import argparse
import os
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import igrip
from benchmarks.measure_poses import model_gap
from benchmarks.moved_things import RATE, MovedThing, moved_thing
from igrip.lab.rendering.layout import PlacedMesh
from igrip.objects.catalog import PAPER_OBJECTS, Catalog
from igrip.perception.poses import POSES

SPEEDS = (0.15, 0.4, 0.8)  # m/s
WITHIN, FAR = 0.020, 0.040  # m
WARM_UP = 12  # times that `shapes` sees the first frame before; what is young may be the hand
SAME = 0.05  # m; what is followed so near to a thing is that thing


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--films", type=int, default=8, help="of each speed")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--moved", choices=("carried", "pushed"), default="carried")
    parser.add_argument("--poses", default="depth", help="depth, auto or shapes")
    parser.add_argument("--no-hands", action="store_true", help="without the hand's landmarks")
    parser.add_argument("--every", type=int, default=1, help="frames from one look to the next")
    parser.add_argument("--late", type=int, default=1, help="frames by which landmarks are late")
    parser.add_argument("--speeds", type=float, nargs="+", default=SPEEDS)
    parser.add_argument("--keep", type=Path, help="a folder for the films, to render them once")
    parser.add_argument("--verbose", action="store_true", help="each film, each frame")
    arguments = parser.parse_args()
    print(f"{arguments.moved}, {arguments.poses}, every frame of {arguments.every}, hands "
          f"{'none' if arguments.no_hands else f'{arguments.late} frames late'}")  # fmt: skip
    print("speed  within 20 mm   fresh  fresh and > 40 mm off   same id after   seen again within")
    for speed in arguments.speeds:
        catalog = igrip.load_objects("ycb")
        rows: list[dict[str, Any]] = []
        for seed in range(arguments.seed, arguments.seed + arguments.films):
            rows.append(judge(catalog, seed, speed, arguments))
            if arguments.verbose:
                print(_line(speed, rows[-1:]), rows[-1]["name"], f"seed {seed}")
        print(_line(speed, rows))
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


def _line(speed: float, rows: list[dict[str, Any]]) -> str:
    gaps = np.concatenate([row["gaps"] for row in rows])
    fresh = np.concatenate([row["fresh"] for row in rows])
    again = [row["again"] for row in rows]
    return (
        f"{speed:4.2f}   {np.mean(gaps <= WITHIN):8.1%}  {np.mean(fresh):10.1%}  "
        f"{np.mean(fresh & (gaps > FAR)):12.1%}  {np.mean([row['same'] for row in rows]):20.0%}  "
        f"{np.median(again):12.2f} s, at most {np.max(again):.2f} s, {len(gaps)} frames"
    )


def judge(
    catalog: Catalog, seed: int, speed: float, arguments: argparse.Namespace
) -> dict[str, Any]:
    """Return for each frame in which a thing moves how far off it is, and whether it was seen."""
    thing = moved_thing(catalog, seed, speed, arguments.moved)
    options = {} if arguments.poses == "shapes" else {"models": PAPER_OBJECTS}
    estimator = POSES.get(arguments.poses)(catalog, options)
    gaps, fresh, landmarks = [], [], []
    id: str | None = None
    released, again, last = None, np.inf, np.inf
    for k, (moment, frame, joints) in enumerate(_rendered(thing, seed, speed, arguments)):
        frame = replace(frame, t=frame.t + WARM_UP / 10)
        landmarks.append(joints)
        if k % arguments.every:
            continue
        for before in range(WARM_UP if k == 0 and arguments.poses == "shapes" else 0):
            estimator.estimate(replace(frame, t=frame.t - (WARM_UP - before) / 10), [joints])
        late = k - arguments.late
        hands = [] if arguments.no_hands or late < 0 else [landmarks[late]]
        poses = estimator.estimate(frame, hands)
        there = PlacedMesh(catalog[thing.name], moment.pose)
        off = {
            one: model_gap(catalog[pose.model or one], there, np.array(pose.position),
                           pose.orientation)
            for one, pose in poses.items() if pose is not None
        }  # fmt: skip
        if moment.phase == "alone" and off:
            near = min(off, key=lambda one: off[one])
            id = near if off[near] < SAME else None
        gap = off.get(id or "", np.inf)
        pose = poses.get(id or "")
        seen = pose is not None and pose.t is not None and pose.t >= frame.t
        if moment.phase == "moves":
            gaps.append(gap)
            fresh.append(seen)
        if moment.phase == "released":
            released = moment.t if released is None else released
            if not np.isfinite(again) and seen and gap <= WITHIN:
                again = moment.t - released
        last = gap
        if arguments.verbose:
            print(f"  {moment.t:5.2f} {moment.phase:8s} {1e3 * gap:6.1f} mm "
                  f"{'fresh' if seen else 'old'}")  # fmt: skip
    estimator.close()
    return {"name": thing.name, "gaps": np.array(gaps), "fresh": np.array(fresh),
            "same": last <= WITHIN, "again": again}  # fmt: skip


def _rendered(thing: MovedThing, seed: int, speed: float, arguments: argparse.Namespace) -> Any:
    """Return the frames of a film; from the folder where they are kept, if any."""
    if arguments.keep is None:
        return thing.frames()
    path = arguments.keep / f"{arguments.moved}-{speed}-{seed}-{RATE:.0f}.pickle"
    if not path.exists():
        arguments.keep.mkdir(parents=True, exist_ok=True)
        path.write_bytes(pickle.dumps(list(thing.frames())))
    return pickle.loads(path.read_bytes())


if __name__ == "__main__":
    main()
