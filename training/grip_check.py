"""The grip by leave-one-source-out: learned from one generator of grasps, judged on the other.

Beside it the paper's rule (``cylinder``), which learns nothing, and the model without the rule
(``sure`` of 0.5). All get the targets of ``bayes``; a trial is right as in ``igrip evaluate``.

Example: python -m training.grip_check --learned 60 --judged 40
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.grips import Grip, GripConfig, GripSelector
from igrip.grips.contact import ContactGrip, weights
from igrip.grips.cylinder import CylinderGrip
from igrip.lab.evaluation.calibration import ReliabilityBins
from igrip.lab.evaluation.trials import causal_accuracy, score_trial
from igrip.targets.bayes import Bayes
from training.grasps import simulate_grasps
from training.grip import approaches_of, fit_grip
from training.moments import Recording, follow
from training.sources import SEED
from training.worlds import simulate_person

Array = NDArray[np.float64]
SOURCES: Mapping[str, Callable[[int, int], list[Recording]]] = {
    "worlds": simulate_person, "grasps": simulate_grasps,
}  # fmt: skip
JUDGES = 10_000  # number of the first person who judges; none is learned from
PARTS = (0.4, 0.6, 0.85)  # of the movement
SURE = (0.5, 0.7, 0.8, 0.9, 0.95, 0.98)
MIN_UPRIGHT = 0.9  # vertical part of the axis of an object that stands


class Graded(NamedTuple):
    """How the grips of one selector did in one reach.

    Attributes
    ----------
    success : bool
        By the rule of a trial.
    accurate : (p,) bool
        Whether the newest prediction was right at parts of the movement.
    stated, right : lists
        From onset to end: the probability of the likelier grip, and whether that was right.
    """

    success: bool
    accurate: NDArray[np.bool_]
    stated: list[float]
    right: list[bool]


def grasps_of(source: str, number: int) -> Iterator[Recording]:
    """Yield the reaches of one person whose grip is known and whose target is there."""
    for recording in SOURCES[source](SEED, number):
        if recording.grip is not None and recording.target is not None and not recording.absent:
            yield recording


def learned_rows(source: str, number: int) -> list[Array]:
    """Return what is learned from one person."""
    return [approaches_of(recording, follow(recording)) for recording in grasps_of(source, number)]


def judged(
    source: str, selectors: Mapping[str, GripSelector], number: int
) -> list[tuple[str, dict[str, Graded]]]:
    """Return, for each reach of one person, whether its target stands or lies, and all grades."""
    results = []
    for recording in grasps_of(source, number):
        posterior, times = Bayes(), []
        grips: dict[str, list[Grip]] = {name: [] for name in selectors}
        stance = "stands"
        for motion, geometry in follow(recording):
            estimate = posterior.update(motion, geometry, {})
            ids = [placed.id for placed in geometry.objects]
            if recording.target in ids:
                up = geometry.cylinders().axis[ids.index(str(recording.target)), 2]
                stance = "stands" if abs(up) >= MIN_UPRIGHT else "lies"
            times.append(motion.t)
            for name, selector in selectors.items():
                grips[name].append(selector.select(estimate, geometry, motion))
        if times:
            graded = {name: grade(recording, times, one) for name, one in grips.items()}
            results.append((stance, graded))
    return results


def grade(recording: Recording, times: Sequence[float], grips: Sequence[Grip]) -> Graded:
    """Grade the grips at times [s] of one reach."""
    right = np.array([grip.name == recording.grip for grip in grips], dtype=bool)
    bounds = recording.onset, recording.end
    stated, hits = [], []
    for t, grip in zip(times, grips, strict=True):
        if grip.probability is not None and bounds[0] <= t <= bounds[1]:
            likelier, p = max(grip.probability.items(), key=lambda item: item[1])
            stated.append(p)
            hits.append(likelier == recording.grip)
    accurate = causal_accuracy(np.array(times), right, *bounds, PARTS)
    return Graded(score_trial(np.array(times), right, *bounds).success, accurate, stated, hits)


def row_of(graded: Sequence[Graded]) -> list[str]:
    """Return trials that are right, accuracy on the way, and calibration error, as cells."""
    success = f"{100 * np.mean([g.success for g in graded]):.1f} %"
    parts = [f"{100 * share:.0f}" for share in np.mean([g.accurate for g in graded], axis=0)]
    stated = [p for g in graded for p in g.stated]
    right = [hit for g in graded for hit in g.right]
    error = ReliabilityBins.of(stated, right).calibration_error() if stated else None
    return [success, " / ".join(parts) + " %", "" if error is None else f"{error:.3f}"]


def main() -> None:
    """Learn from each source, and print the tables."""
    parser = argparse.ArgumentParser(
        prog="python -m training.grip_check", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--learned", type=int, default=60, help="people of each source to learn")
    parser.add_argument("--judged", type=int, default=40, help="people of each source who judge")
    asked = parser.parse_args()
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        learned = {"what ships": weights()}
        for source in SOURCES:
            rows = pool.map(partial(learned_rows, source), range(asked.learned))
            fitted = fit_grip([x for one in rows for x in one])
            learned[source] = np.array(list(fitted.values()))
            print(f"learned from {source}", flush=True)
        print("\n| judged on | reaches | learned from | trials | at 40 / 60 / 85 % | ECE |")
        print(f"|{' --- |' * 6}")
        for source in SOURCES:
            selectors: dict[str, GripSelector] = {"cylinder": CylinderGrip(GripConfig())}
            for name, values in learned.items():
                if name != source:
                    for sure in SURE:
                        config = GripConfig(sure=sure)
                        selectors[f"{name}, sure {sure}"] = ContactGrip(config, values)
            people = range(JUDGES, JUDGES + asked.judged)
            each = [x for one in pool.map(partial(judged, source, selectors), people) for x in one]
            for stance in sorted({stance for stance, _ in each}, reverse=True):
                for name in selectors:
                    own = [grades[name] for where, grades in each if where == stance]
                    cells = [f"{source}, {stance}", str(len(own)), name, *row_of(own)]
                    print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
