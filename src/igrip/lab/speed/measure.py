"""The measurements of ``igrip bench``, as plain data."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.lab.speed import scenes
from igrip.lab.speed.peers import PAPER, TRIMESH, WARM_UP, Recorded, warm
from igrip.lab.speed.timing import Work, interleaved, percentiles
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

OWN = "igrip, update"
WITH_BAYES = "igrip, update with bayes"
CONFIGS = {OWN: PAPER, WITH_BAYES: Config(targets="bayes")}
BAYES_RATIO = "update with bayes / with paper"


def machine() -> dict[str, Any]:
    """Describe the machine, and whether it is idle before the measurements begin."""
    load = list(os.getloadavg()) if hasattr(os, "getloadavg") else None
    return {
        "platform": platform.platform(),
        "python": platform.python_version(),
        "processors": os.cpu_count(),
        "load_average": load,
        "idle": load is None or load[0] < 0.5 * (os.cpu_count() or 1),
    }


def compare(
    catalog: Catalog,
    recorded: Recorded,
    peers: Mapping[str, Work],
    runs: int,
    plain_frames: int,
    turn: int = 1,
    configs: Mapping[str, Config] = CONFIGS,
) -> dict[str, Any]:
    """Time ``update`` beside other engines on the same frames, by turns.

    Two hands, the paper's four objects, 10 predicted points × 36 rays, the distances of the hand
    and of its predicted points to the nearest vertex. The peers' rays are prepared beforehand:
    only the casting is timed. ``ratios`` are the best of the runs, as are the times of ``best``.
    """
    observations = recorded.observations
    table = []
    for _ in range(runs):
        contestants: dict[str, Work] = {}
        for name, config in configs.items():
            estimator = warm(Estimator(catalog, config), observations)
            contestants[name] = lambda k, e=estimator: e.update(observations[k])  # type: ignore[misc]
        times = interleaved({**contestants, **peers}, range(WARM_UP, len(observations)), turn)
        table.append({name: percentiles(seconds) for name, seconds in times.items()})
    plain = recorded.plain_trimesh(plain_frames)
    of_runs = ratios_of_runs(table, list(peers))
    return {
        "runs": table,
        "best": {name: min((run[name] for run in table), key=_median) for name in table[0]},
        "plain_trimesh": plain,
        "ratios_of_runs": of_runs,
        "ratios": best_ratios(of_runs, table, plain),
        "missing": recorded.missing,
    }


def _median(times: dict[str, float]) -> float:
    return times["p50_ms"]


def ratios_of_runs(
    runs: Sequence[Mapping[str, dict[str, float]]], peers: Sequence[str]
) -> dict[str, list[float]]:
    """Return the ratio of medians to each peer, run by run."""
    return {
        f"update / {name}": [_median(run[OWN]) / _median(run[name]) for run in runs]
        for name in peers
    } | {BAYES_RATIO: [_median(run[WITH_BAYES]) / _median(run[OWN]) for run in runs]}


def best_ratios(
    of_runs: Mapping[str, Sequence[float]],
    runs: Sequence[Mapping[str, dict[str, float]]],
    plain: dict[str, float] | None,
) -> dict[str, float]:
    """Return the best ratio to each peer; that of trimesh is to the median of all runs."""
    ratios = {name: min(values) for name, values in of_runs.items()}
    if plain is not None:
        own = float(np.median([_median(run[OWN]) for run in runs]))
        ratios[f"{TRIMESH} / update"] = _median(plain) / own
    return ratios


def at_cadence(catalog: Catalog, seconds: float) -> dict[str, float]:
    """Time ``update`` at a real 30 Hz, where the caches go cold between frames."""
    observations = scenes.frames(WARM_UP + int(seconds * scenes.RATE))
    estimator = warm(Estimator(catalog, PAPER), observations)
    work = {"update": lambda k: estimator.update(observations[k])}
    frames = range(WARM_UP, len(observations))
    return percentiles(interleaved(work, frames, period=1.0 / scenes.RATE)["update"])


def growth(
    cases: Mapping[Any, tuple[Estimator, Sequence[Observation]]], frames: int, turn: int = 1
) -> list[dict[str, Any]]:
    """Time ``update`` of several estimators, each on its own frames, by turns.

    Each row has the times of a case, and the rays cast and tree nodes visited per frame.
    """
    works = {str(case): lambda k, e=e, o=o: e.update(o[k]) for case, (e, o) in cases.items()}
    for estimator, observations in cases.values():
        warm(estimator, observations)
    before = {case: estimator.scene.counters.copy() for case, (estimator, _) in cases.items()}
    times = interleaved(works, range(WARM_UP, WARM_UP + frames), turn)
    rows = []
    for case, (estimator, _) in cases.items():
        counts = ((estimator.scene.counters - before[case]) / frames).tolist()
        work = dict(zip(("ray_nodes", "point_nodes", "rays"), counts, strict=True))
        rows.append({"case": case, **percentiles(times[str(case)]), **work})
    return rows


def growth_with_objects(
    catalog: Catalog, numbers: Sequence[int], frames: int, turn: int = 1
) -> list[dict[str, Any]]:
    """Time ``update`` with different numbers of objects."""
    cases = {
        number: (Estimator(catalog, PAPER), scenes.frames(WARM_UP + frames, number))
        for number in numbers
    }
    return growth(cases, frames, turn)


def memory(catalog: Catalog, frames: int) -> dict[str, Any]:
    """Return how much the process grows in the second half of a long run [MB]."""
    estimator = Estimator(catalog, PAPER)
    base = scenes.frames(360)
    length = base[-1].t + 1.0 / scenes.RATE
    sizes = []
    for number in range(frames):
        lap, k = divmod(number, len(base))
        message = base[k]
        estimator.update(Observation(message.t + lap * length, message.hands, message.objects))
        if number in (frames // 2, frames - 1):
            sizes.append(resident_memory())
    return {"frames": frames, "growth_mb": sizes[-1] - sizes[0], "resident_mb": sizes[-1]}


def resident_memory() -> float:
    """Return the resident size of this process [MB]; its peak on systems without ``/proc``."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
