"""The measurements of ``python -m benchmarks``, as plain data."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import trimesh

from igrip.config import Config
from igrip.cues import CueConfig
from igrip.estimator import Estimator
from igrip.geometry.scene import RayConfig
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from igrip.lab.speed import measure, scenes
from igrip.lab.speed.measure import BAYES_RATIO, CONFIGS, OWN
from igrip.lab.speed.peers import EMBREE, PAPER, TRIMESH, WARM_UP, Recorded, warm
from igrip.objects.catalog import PAPER_OBJECTS, Catalog, load_objects
from igrip.observation import Observation

from .peers import peers

BY_SURFACE = "igrip, update with distances to surfaces"
SURFACE = Config(targets="paper", cues=CueConfig(distance="surface"))


def against_peers(
    catalog: Catalog, frames: int, runs: int, plain_frames: int, turn: int
) -> dict[str, Any]:
    """Time ``update``, also with surface distances, beside every engine that is installed."""
    recorded = Recorded.run(catalog, frames)
    return measure.compare(
        catalog,
        recorded,
        peers(catalog, recorded),
        runs,
        plain_frames,
        turn,
        {**CONFIGS, BY_SURFACE: SURFACE},
    )


def growth(catalog: Catalog, frames: int, turn: int) -> dict[str, list[dict[str, Any]]]:
    """Time ``update`` with more objects, more rays and finer meshes."""

    def case(
        source: Catalog, rays: int = 36, models: Sequence[str] = PAPER_OBJECTS
    ) -> tuple[Estimator, list[Observation]]:
        config = Config(targets="paper", rays=RayConfig(rays_per_cone=rays))
        return Estimator(source, config), scenes.frames(WARM_UP + frames, models=models)

    with tempfile.TemporaryDirectory() as folder:
        spheres = {}
        for subdivisions in (2, 3, 4, 5):
            mesh = trimesh.creation.icosphere(subdivisions, radius=0.06)
            mesh.export(f"{folder}/{len(mesh.faces)}.ply")
            spheres[len(mesh.faces)] = str(len(mesh.faces))
        balls = load_objects(folder)
        by_rays = {n: case(catalog, rays=n) for n in (12, 36, 108)}
        by_faces = {n: case(balls, models=[name]) for n, name in spheres.items()}
        return {
            "objects": measure.growth_with_objects(catalog, (1, 4, 20, 100), frames, turn),
            "rays": measure.growth(by_rays, frames, turn),
            "faces": measure.growth(by_faces, frames, turn),
        }


def batch(catalog: Catalog, frames: int) -> dict[str, float]:
    """Time a replay as ``igrip replay`` does it: messages from a file, one hand, four objects."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "batch.jsonl"
        with JsonlWriter(path) as writer:
            for observation in scenes.frames(frames, hands=1):
                writer.write(observation)
        warm(Estimator(catalog, PAPER), scenes.frames(WARM_UP, hands=1))
        begin = time.perf_counter()
        estimator = Estimator(catalog, PAPER)
        for observation in JsonlReader(path):
            estimator.update(observation)
        seconds = time.perf_counter() - begin
    return {"frames": frames, "seconds": seconds, "times_real_time": frames / scenes.RATE / seconds}


def bars(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Return what is aimed at and what was measured, as far as it was.

    Each row has ``quantity``, ``max`` (or ``min``), ``measured`` and ``reached``; None: not judged,
    since the machine is not idle.
    """
    own = report["peers"]["best"][OWN]
    ratios = report["peers"]["ratios"]
    objects = {row["case"]: row["p50_ms"] for row in report["growth"]["objects"]}
    rows: list[dict[str, Any]] = [
        {"quantity": f"update / {EMBREE}", "max": 2.5},
        {"quantity": f"{TRIMESH} / update", "min": 50.0},
        {"quantity": BAYES_RATIO, "max": 1.5},
        {"quantity": "100 objects / 4 objects", "max": 12.0, "measured": objects[100] / objects[4]},
        {"quantity": "update, p50 [ms], if idle", "max": 0.5, "measured": own["p50_ms"]},
        {"quantity": "update, p99 [ms], if idle", "max": 1.0, "measured": own["p99_ms"]},
    ]
    if "batch" in report:
        speed = report["batch"]["times_real_time"]
        rows.append({"quantity": "replay, times real time", "min": 100, "measured": speed})
    if "memory" in report:
        grown = report["memory"]["growth_mb"]
        rows.append({"quantity": "growth of memory [MB]", "max": 1.0, "measured": grown})
    for row in rows:
        row.setdefault("measured", ratios.get(row["quantity"]))
        if row["measured"] is not None:
            row["reached"] = (
                row["measured"] <= row["max"] if "max" in row else row["measured"] >= row["min"]
            )
        if row["quantity"].endswith("if idle") and not report["machine"]["idle"]:
            row["reached"] = None
    return [row for row in rows if row["measured"] is not None]
