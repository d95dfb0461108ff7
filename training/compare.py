"""Compare likelihoods on people and simulations that none of them was trained on.

``python -m training.compare SHARED`` prints for each candidate the accuracy of moments:
the newest one at 40 and 60 % of the movement, without any memory. Real people: the validation fold
(not the people who are kept back to judge by); simulated ones: others than those learned from.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from igrip.io.importers import RecordedReach
from igrip.io.resampling import ImportOptions, resample
from igrip.targets.learned.features import LOCAL
from igrip.targets.learned.network import MAX_INPUT
from training.__main__ import weighted
from training.learn import Network, fit, inputs_of, standardised
from training.logit import Terms, fit_logit, linear, logit_scores, quadratic
from training.moments import Moments, Recording, catalog, follow, joined, moments_of
from training.people import LEARNED_FROM, VALIDATION, real_recordings
from training.sources import PERSONS, SEED, gather
from training.worlds import simulate_person

Array = NDArray[np.float64]
Scores = Callable[[Moments], Array]
NOISE = 0.004  # m
MORE = 40  # simulated people


def validation_reach(job: tuple[RecordedReach, int]) -> tuple[str, Moments]:
    """Return a real reach as the evaluation replays it."""
    reach, seed = job
    options = ImportOptions(rate=30.0, noise=NOISE, seed=seed)
    recording = Recording(
        reach.participant, str(reach.extra["distance"]), resample(reach, catalog(), options),
        reach.hand, reach.target, -1e-9, float(reach.times[-1]), math.inf, 30.0,
    )  # fmt: skip
    return recording.kind, moments_of(recording, follow(recording))


def simulated(number: int) -> list[tuple[str, Moments]]:
    """Return the reaches of one more simulated person."""
    reaches = [r for r in simulate_person(SEED, number) if r.kind == "reach"]
    return [("simulated", moments_of(recording, follow(recording))) for recording in reaches]


def accuracy(moments: Moments, scores: Array, part: float) -> float:
    """Return the share of recordings right at a part of the movement, over those that moved."""
    right = []
    ends = np.append(np.flatnonzero(np.diff(moments.frame, prepend=-1)), len(moments.frame))
    for trial in np.unique(moments.trial):
        frames = np.flatnonzero((moments.trial == trial) & (moments.part <= part + 1e-9))
        if not len(frames):
            right.append(False)
            continue
        first, last = ends[frames[-1]], ends[frames[-1] + 1]
        best = first + int(np.argmax(scores[first:last]))
        right.append(best == moments.target[frames[-1]])
    return float(np.mean(right))


def endpoint(moments: Moments) -> Array:
    """Return scores of a minimum jerk alone: how far it would still go, against what remains.

    With distance d, speed v and time t since onset, ``v t / d`` gives the phase of a minimum jerk
    (Flash & Hogan 1985), and the phase the whole length; an object at that distance is likelier.
    """
    phase = np.linspace(0.05, 1.0, 96)
    done = phase**3 * (10.0 - 15.0 * phase + 6.0 * phase**2)
    ratio = 30.0 * phase**3 * (1.0 - phase) ** 2 / done
    shared = moments.shared[moments.frame]
    now = np.interp(-shared[:, 1], -ratio, phase)
    whole = now**3 * (10.0 - 15.0 * now + 6.0 * now**2)
    covered = moments.local[:, LOCAL.index("distance_covered")]
    heading = moments.local[:, LOCAL.index("heading_so_far")]
    return -((covered - whole) ** 2) / 0.02 - (1.0 - heading) / 0.02


def main() -> None:
    """Train every candidate on the same moments and print a table."""
    shared = Path(sys.argv[1])
    folds = [fold for fold in LEARNED_FROM if fold != VALIDATION]
    moments = weighted(gather(shared, folds=folds))
    with ProcessPoolExecutor() as pool:
        judged = list(
            pool.map(
                validation_reach,
                real_recordings(shared / "wispinski2021", 3, [VALIDATION]),
                chunksize=40,
            )
        )
        for part in pool.map(simulated, range(PERSONS["worlds"], PERSONS["worlds"] + MORE)):
            judged += part
    sets = {
        kind: joined([m for k, m in judged if k == kind]) for kind in ("near", "far", "simulated")
    }
    candidates: list[tuple[str, Scores]] = [("minimum jerk and direction", endpoint)]
    inputs, mean, scale = standardised(inputs_of(moments))
    for name, terms in (("logit, linear", linear), ("logit, quadratic", quadratic)):
        weights = fit_logit(inputs, moments, terms)
        candidates.append((name, partial(_logit, mean, scale, weights, terms)))

    def fitted(units: int) -> Network:
        return fit(inputs, moments, SEED, none=True, units=units)[0]

    for units in (8, 16, 32, 48):
        candidates.append(
            (f"network, {units} units", partial(_network, mean, scale, fitted(units)))
        )
    print("| likelihood | near, 40 / 60 % | far | their mean | simulated |")
    print("| --- | --- | --- | --- | --- |")
    for name, scores in candidates:
        at = {k: [100.0 * accuracy(m, scores(m), p) for p in (0.4, 0.6)] for k, m in sets.items()}
        both = [0.5 * (a + b) for a, b in zip(at["near"], at["far"], strict=True)]
        cells = [f"{a:.1f} / {b:.1f}" for a, b in (at["near"], at["far"], both, at["simulated"])]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


def _logit(mean: Array, scale: Array, weights: Array, terms: Terms, moments: Moments) -> Array:
    return logit_scores(inputs_of(moments), mean, scale, weights, terms)


def _network(mean: Array, scale: Array, network: Network, moments: Moments) -> Array:
    z = np.clip((inputs_of(moments) - mean) / scale, -MAX_INPUT, MAX_INPUT)
    units = np.tanh(z @ network.hidden + network.bias)
    scores: Array = units @ network.out_weights + network.out_bias[0]
    return scores


if __name__ == "__main__":
    main()
