"""What the grasp candidates are worth: the tables of docs/grips.md.

python -m benchmarks.measure_grasps candidates     # of every model: how many, how long
python -m benchmarks.measure_grasps reaches        # simulated reaches for candidates
python -m benchmarks.measure_grasps cost           # of one update, against the other selectors
python -m benchmarks.measure_grasps sizes FOLDER   # grip class in real reaches (grasp_sizes)
python -m benchmarks.measure_grasps depths FOLDER  # opening in real reaches (grasp_depths)
"""

from __future__ import annotations

import argparse
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import igrip
from benchmarks.real_grasps import print_depths, print_sizes
from igrip.grasps.build import build_candidates
from igrip.grips import GRIPS
from igrip.lab.simulation.grasp_reach import GraspReach, draw_grasp_reach
from igrip.objects.declared_grasp import DeclaredGrasp
from igrip.objects.model import ObjectModel
from igrip.taxonomy import paper_grip

PARTS = (0.4, 0.6, 0.8, 1.0)
FOUND = ("003_cracker_box", "005_tomato_soup_can", "006_mustard_bottle", "025_mug")
ANY = 3.1415


def declared_models() -> dict[str, ObjectModel]:
    """Return a can, a bottle, a box and a rod with grasps that are declared, in metres."""

    def side(grip: str, radius: float, height: float = 0.0, part: str = "body") -> DeclaredGrasp:
        return DeclaredGrasp(
            grip=grip, part=part, point=(0, 0, height), approach=(0, 1, 0), closing=(1, 0, 0),
            opening=2 * radius, depth=radius, axis=(0, 0, 1), turn=ANY,
        )  # fmt: skip

    def top(grip: str, half: float, opening: float, turn: float = ANY) -> DeclaredGrasp:
        return DeclaredGrasp(
            grip=grip, part="end", point=(0, 0, half - 0.015), approach=(0, 0, -1),
            closing=(1, 0, 0), opening=opening, depth=0.015, axis=(0, 0, 1), turn=turn,
        )  # fmt: skip

    def face(x: float, y: float, opening: float, depth: float) -> DeclaredGrasp:
        return DeclaredGrasp(
            grip="palmar", part="body", point=(0, 0, 0), approach=(-x, -y, 0), closing=(-y, x, 0),
            opening=opening, depth=depth,
        )  # fmt: skip

    declared: dict[str, list[DeclaredGrasp]] = {
        "cylinder:0.033x0.10": [side("palmar", 0.033), top("pinch", 0.05, 0.066)],
        "cylinder:0.02x0.24": [side("medium_wrap", 0.02), top("tripod", 0.12, 0.04)],
        "box:0.09x0.07x0.21": [
            face(0, 1, 0.09, 0.035), face(0, -1, 0.09, 0.035), face(1, 0, 0.07, 0.045),
            face(-1, 0, 0.07, 0.045), top("pinch", 0.105, 0.07, 0.0),
        ],
        "cylinder:0.045x0.16": [side("palmar", 0.045, -0.02), top("pinch", 0.08, 0.09)],
    }  # fmt: skip
    catalog = igrip.load_objects(*declared)
    return {name: replace(catalog[name], grasps=tuple(g)) for name, g in declared.items()}


class Models(dict[str, ObjectModel]):
    """Models as a catalogue."""


def reaches(
    models: Mapping[str, ObjectModel], count: int, seed: int, turned: bool
) -> Iterator[GraspReach]:
    """Yield so many simulated reaches."""
    random = np.random.default_rng(seed)
    while count:
        reach = draw_grasp_reach(models, random, turned)
        if reach is not None:
            count -= 1
            yield reach


def measure(
    models: Mapping[str, ObjectModel], count: int, seed: int, turned: bool, grips: str
) -> dict[float, Counter[str]]:
    """Return how many of the reaches are told rightly after each part of the movement."""
    found: dict[float, Counter[str]] = {part: Counter() for part in PARTS}
    for reach in reaches(models, count, seed, turned):
        estimator = igrip.Estimator(Models(models), igrip.Config(grips=grips))  # type: ignore[arg-type]
        every = [i for m in reach.messages for i in estimator.update(m)]
        for part in PARTS:
            told = [i for i in every if i.t <= reach.at(part) + 1e-9][-1]
            score = found[part]
            score["reaches"] += 1
            score["target"] += told.target == reach.target
            if told.grip is None:
                continue
            score["grip"] += told.grip == reach.grasp.grip
            score["two"] += paper_grip(told.grip) == paper_grip(reach.grasp.grip)
            if told.aperture is None or told.wrist is None:
                continue
            score["opening"] += abs(told.aperture - reach.grasp.opening) <= 0.010
            off = abs((told.wrist - reach.wrist + math.pi / 2) % math.pi - math.pi / 2)
            score["wrist"] += off <= math.radians(20.0)
    return found


def print_reaches(count: int, seed: int) -> None:
    """Print the table of simulated reaches."""
    catalog = igrip.load_objects("ycb")
    sets = {"declared": declared_models(), "found": {name: catalog[name] for name in FOUND}}
    print("| candidates | hand turned | selector | part | target | grip | two grips | opening "
          "within 10 mm | wrist within 20° |")  # fmt: skip
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, models in sets.items():
        for turned, grips in ((False, "cylinder"), (False, "candidates"), (True, "candidates")):
            for part, score in measure(models, count, seed, turned, grips).items():
                total = score["reaches"]
                cells = [f"{100 * score[key] / total:.1f} %"
                         for key in ("target", "grip", "two", "opening", "wrist")]  # fmt: skip
                row = [name, "measured" if turned else "no", grips, f"{part:.0%}", *cells]
                print("| " + " | ".join(row) + " |", flush=True)


def print_candidates(names: Sequence[str]) -> None:
    """Print how many candidates each model has, of which grips, and how long that took."""
    catalog = igrip.load_objects("ycb")
    build_candidates(catalog["056_tennis_ball"])  # the kernels are compiled
    print("| model | candidates | grips | seconds |\n| --- | --- | --- | --- |")
    for name in names or catalog:
        model = catalog[name]
        begin = time.perf_counter()
        found = build_candidates(model)
        lasted = time.perf_counter() - begin
        grips = Counter(c.grip for c in found)
        text = ", ".join(f"{count} {grip}" for grip, count in grips.most_common())
        print(f"| {name} | {len(found)} | {text} | {lasted:.2f} |", flush=True)


def print_cost(rounds: int = 5) -> None:
    """Print the median time of an update with each selector, measured in turns."""
    catalog = igrip.load_objects("ycb")
    models = {name: catalog[name] for name in (*FOUND[:3], "021_bleach_cleanser")}
    every = list(reaches(models, 6, 0, turned=False))
    for grips in GRIPS.names():
        _times(every, catalog, grips)
    medians: dict[str, list[float]] = {name: [] for name in GRIPS.names()}
    for _ in range(rounds):
        for grips in GRIPS.names():
            medians[grips].append(float(np.median(_times(every, catalog, grips))))
    base = min(medians["contact"])
    print("| selector | median of an update | against `contact` |\n| --- | --- | --- |")
    for grips, values in medians.items():
        print(f"| `{grips}` | {1e3 * min(values):.3f} ms | {min(values) / base:.2f} |")


def _times(every: Sequence[GraspReach], catalog: igrip.Catalog, grips: str) -> list[float]:
    times = []
    for reach in every:
        estimator = igrip.Estimator(catalog, igrip.Config(grips=grips))
        for message in reach.messages:
            begin = time.perf_counter()
            estimator.update(message)
            times.append(time.perf_counter() - begin)
    return times


def main() -> None:
    """Print the table that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", choices=("candidates", "reaches", "cost", "sizes", "depths"))
    parser.add_argument("names", nargs="*", help="models, or the folder of the real reaches")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    tables: dict[str, Callable[[], None]] = {
        "candidates": lambda: print_candidates(options.names),
        "reaches": lambda: print_reaches(options.count, options.seed),
        "cost": print_cost,
        "sizes": lambda: print_sizes(Path(options.names[0])),
        "depths": lambda: print_depths(Path(options.names[0])),
    }
    tables[options.table]()


if __name__ == "__main__":
    main()
