"""The measurements of ``igrip bench``, as plain data."""

from __future__ import annotations

import os
import platform
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from igrip.benchmark import scenes
from igrip.benchmark.peers import Embree, EmbreeNumpy, PlainTrimesh, Workload
from igrip.benchmark.timing import interleaved, milliseconds
from igrip.config import Config
from igrip.cues import CueConfig
from igrip.estimator import Estimator
from igrip.geometry.scene import RayConfig
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.motion.trajectory import Motion
from igrip.objects.catalog import PAPER_OBJECTS, Catalog, load_objects
from igrip.observation import Observation

TARGETS = "paper"  # the estimator that is timed
OWN = "igrip, update"
BY_SURFACE = "igrip, update with distances to surfaces"
WITH_BAYES = "igrip, update with bayes"
DEARER = "update with bayes / with paper"
WARM_UP = 40  # frames before the clock runs: the window is full, and the code compiled
Step = Callable[[str], None]


def bars(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Return what is aimed at (DESIGN §7) and what was measured, as far as it was.

    Each row has ``what``, ``most`` (or ``least``), ``measured`` and ``reached``.
    """
    own = report["peers"]["best"][OWN]
    ratios = report["peers"]["ratios"]
    objects = {row["case"]: row["p50_ms"] for row in report["growth"]["objects"]}
    rows: list[dict[str, Any]] = [
        {"what": "update / embreex, rays alone", "most": 2.5},
        {"what": "trimesh without embree, rays alone / update", "least": 50.0},
        {"what": DEARER, "most": 1.5},
        {"what": "100 objects / 4 objects", "most": 12.0, "measured": objects[100] / objects[4]},
        {"what": "update, p50 [ms], if idle", "most": 0.5, "measured": own["p50_ms"]},
        {"what": "update, p99 [ms], if idle", "most": 1.0, "measured": own["p99_ms"]},
    ]
    if "batch" in report:
        fast = report["batch"]["times_real_time"]
        rows.append({"what": "replay, times real time on a core", "least": 100, "measured": fast})
    if "memory" in report:
        grown = report["memory"]["growth_mb"]
        rows.append({"what": "growth of memory [MB]", "most": 1.0, "measured": grown})
    for row in rows:
        row.setdefault("measured", ratios.get(row["what"]))
        if row["measured"] is not None:
            row["reached"] = (
                row["measured"] <= row["most"] if "most" in row else row["measured"] >= row["least"]
            )
        if row["what"].endswith("if idle") and not report["machine"]["idle"]:
            row["reached"] = None
    return [row for row in rows if row["measured"] is not None]


def machine() -> dict[str, Any]:
    """Return what the times are taken on, and whether it is idle before it all begins."""
    load = list(os.getloadavg()) if hasattr(os, "getloadavg") else None
    return {
        "platform": platform.platform(),
        "python": platform.python_version(),
        "processors": os.cpu_count(),
        "load_average": load,
        "idle": load is None or load[0] < 0.5 * (os.cpu_count() or 1),
    }


def run_frames(estimator: Estimator, frames: Sequence[Observation]) -> list[float]:
    """Return the seconds each ``update`` takes."""
    times = []
    for frame in frames:
        begin = time.perf_counter()
        estimator.update(frame)
        times.append(time.perf_counter() - begin)
    return times


def against_peers(
    catalog: Catalog, frames: int, runs: int, plain_frames: int, turn: int = 1
) -> dict[str, Any]:
    """Time ``update`` beside other engines at the same frames, in turn; the best of several runs.

    Two hands, the paper's four objects, 10 predicted points × 36 rays, the distance of the
    hand and of its predicted points to the nearest vertex. The rays of
    the other engines are prepared beforehand: only the casting is timed.
    """
    observations = scenes.frames(WARM_UP + frames)
    config = Config(targets=TARGETS)
    own = {
        OWN: config,
        BY_SURFACE: Config(targets=TARGETS, cues=CueConfig(distance="surface")),
        WITH_BAYES: Config(targets="bayes"),
    }
    recorder = Estimator(catalog, config)
    workloads, windows = _record(recorder, observations)
    objects = recorder.objects
    peers: dict[str, Callable[[int], object]] = {}
    missing: list[str] = []
    try:
        embree, whole = Embree(objects), EmbreeNumpy(objects, config.rays.rays_per_cone, 0.3, 10)
        rays = [embree.prepare(workload) if workload else [] for workload in workloads]
        peers["embreex, rays alone"] = lambda k: embree.cast(rays[k]) if rays[k] else None
        peers["embreex, whether rays meet"] = lambda k: (
            embree.cast(rays[k], "OCCLUDED") if rays[k] else None
        )
        peers["embreex + numpy + scipy, frame"] = lambda k: whole.frame(windows[k])
    except ImportError as error:
        missing.append(str(error))
    table: list[dict[str, Any]] = []
    for _ in range(runs):
        contestants: dict[str, Callable[[int], object]] = {}
        for name, chosen in own.items():
            estimator = Estimator(catalog, chosen)
            run_frames(estimator, observations[:WARM_UP])
            contestants[name] = lambda k, e=estimator: e.update(observations[k])  # type: ignore[misc]
        times = interleaved(contestants | peers, range(WARM_UP, WARM_UP + frames), turn)
        table.append({name: milliseconds(seconds) for name, seconds in times.items()})
    best = {name: min((run[name] for run in table), key=lambda m: m["p50_ms"]) for name in table[0]}
    result: dict[str, Any] = {"runs": table, "best": best, "missing": missing}
    result["plain_trimesh"] = _plain_trimesh(objects, workloads, plain_frames, missing)
    result["ratios_of_runs"] = _ratios_of_runs(table)
    result["ratios"] = _ratios(table, result["plain_trimesh"])
    return result


def _record(
    estimator: Estimator, observations: Sequence[Observation]
) -> tuple[list[Workload | None], list[list[tuple[Any, Any]]]]:
    """Note the rays and windows of every frame, for the peers."""
    workloads: list[Workload | None] = []
    windows: list[list[tuple[Any, Any]]] = []
    for observation in observations:
        estimator.update(observation)
        tracks = list(estimator.hands.values())
        motions: list[Motion] = [t.motion for t in tracks if t.motion is not None]
        placed = estimator.objects
        workloads.append(Workload(estimator.scene, motions, placed) if motions else None)
        windows.append(
            [
                (
                    (np.arange(len(t.trajectory)) - len(t.trajectory) + 1) / scenes.RATE,
                    t.trajectory.past,
                )
                for t in tracks
            ]
        )
    return workloads, windows


def _plain_trimesh(
    objects: Sequence[Any], workloads: Sequence[Workload | None], frames: int, missing: list[str]
) -> dict[str, float] | None:
    if not frames:
        return None
    try:
        engine = PlainTrimesh(objects)
        chosen = [w for w in workloads if w is not None][
            WARM_UP :: max(1, len(workloads) // frames)
        ]
        times = interleaved({"rays": lambda k: engine.cast(chosen[k])}, range(len(chosen[:frames])))
    except ImportError as error:
        missing.append(str(error))
        return None
    return milliseconds(times["rays"])


def _ratios_of_runs(runs: Sequence[dict[str, Any]]) -> dict[str, list[float]]:
    """Return the ratio of medians to each peer, run by run."""
    peers = [name for name in runs[0] if name not in (OWN, BY_SURFACE, WITH_BAYES)]
    return {
        f"update / {name}": [run[OWN]["p50_ms"] / run[name]["p50_ms"] for run in runs]
        for name in peers
    } | {DEARER: [run[WITH_BAYES]["p50_ms"] / run[OWN]["p50_ms"] for run in runs]}


def _ratios(runs: Sequence[dict[str, Any]], plain: dict[str, float] | None) -> dict[str, float]:
    """Return the best ratio of medians to each peer."""
    ratios = {name: min(values) for name, values in _ratios_of_runs(runs).items()}
    if plain is not None:
        usual = float(np.median([run[OWN]["p50_ms"] for run in runs]))
        ratios["trimesh without embree, rays alone / update"] = plain["p50_ms"] / usual
    return ratios


def at_cadence(catalog: Catalog, seconds: float) -> dict[str, float]:
    """Time ``update`` at a real 30 Hz, where caches have gone cold between frames."""
    count = int(seconds * scenes.RATE)
    observations = scenes.frames(WARM_UP + count)
    estimator = Estimator(catalog, Config(targets=TARGETS))
    run_frames(estimator, observations[:WARM_UP])
    work = {"update": lambda k: estimator.update(observations[k])}
    frames = range(WARM_UP, WARM_UP + count)
    return milliseconds(interleaved(work, frames, least=1.0 / scenes.RATE)["update"])


def growth(catalog: Catalog, frames: int, turn: int = 1) -> dict[str, list[dict[str, Any]]]:
    """Time ``update`` with more objects, more rays and finer meshes; the frames are interleaved."""

    def compare(cases: dict[Any, tuple[Estimator, list[Observation]]]) -> list[dict[str, Any]]:
        for estimator, observations in cases.values():
            run_frames(estimator, observations[:WARM_UP])
        works = {str(case): lambda k, e=e, o=o: e.update(o[k]) for case, (e, o) in cases.items()}
        before = {case: estimator.scene.counters.copy() for case, (estimator, _) in cases.items()}
        times = interleaved(works, range(WARM_UP, WARM_UP + frames), turn)
        rows = []
        for case, (estimator, _) in cases.items():
            work = (estimator.scene.counters - before[case]) / frames
            rows.append({"case": case, **milliseconds(times[str(case)]), **_work(work)})
        return rows

    def case(
        source: Catalog, objects: int = 4, rays: int = 36, models: Sequence[str] = PAPER_OBJECTS
    ) -> tuple[Estimator, list[Observation]]:
        config = Config(targets=TARGETS, rays=RayConfig(rays_per_cone=rays))
        return Estimator(source, config), scenes.frames(WARM_UP + frames, objects, models=models)

    with tempfile.TemporaryDirectory() as folder:
        spheres = {}
        for subdivisions in (2, 3, 4, 5):
            mesh = trimesh.creation.icosphere(subdivisions, radius=0.06)
            mesh.export(f"{folder}/{len(mesh.faces)}.ply")
            spheres[len(mesh.faces)] = str(len(mesh.faces))
        balls = load_objects(folder)
        return {
            "objects": compare({n: case(catalog, objects=n) for n in (1, 4, 20, 100)}),
            "rays": compare({n: case(catalog, rays=n) for n in (12, 36, 108)}),
            "faces": compare({n: case(balls, models=[name]) for n, name in spheres.items()}),
        }


def batch(catalog: Catalog, frames: int) -> dict[str, float]:
    """Time a replay as ``igrip replay`` does it: messages from a file, one hand, four objects."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "batch.jsonl"
        with JsonlWriter(path) as writer:
            for observation in scenes.frames(frames, hands=1):
                writer.write(observation)
        estimator = Estimator(catalog, Config(targets=TARGETS))
        run_frames(estimator, scenes.frames(WARM_UP, hands=1))
        begin = time.perf_counter()
        estimator = Estimator(catalog, Config(targets=TARGETS))
        for observation in JsonlReader(path):
            estimator.update(observation)
        seconds = time.perf_counter() - begin
    return {"frames": frames, "seconds": seconds, "times_real_time": frames / scenes.RATE / seconds}


def _work(counters: Any) -> dict[str, float]:
    return {
        "ray_nodes": float(counters[0]),
        "point_nodes": float(counters[1]),
        "rays": float(counters[2]),
    }


def memory(catalog: Catalog, frames: int) -> dict[str, Any]:
    """Return how much the process grew in the second half of a long run [MB]."""
    estimator = Estimator(catalog, Config(targets=TARGETS))
    base = scenes.frames(360)
    length = base[-1].t + 1.0 / scenes.RATE
    sizes = []
    for number in range(frames):
        turn, k = divmod(number, len(base))
        message = base[k]
        moved = Observation(message.t + turn * length, message.hands, message.objects)
        estimator.update(moved)
        if number == frames // 2:
            sizes.append(_resident())
    sizes.append(_resident())
    return {"frames": frames, "growth_mb": sizes[1] - sizes[0], "resident_mb": sizes[1]}


def _resident() -> float:
    """Return the resident size of this process [MB]; its peak where the system tells no more."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
