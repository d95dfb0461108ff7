"""Small datasets for the tests of recordings, evaluation and commands."""

import os
from pathlib import Path

import numpy as np

from igrip import Observation
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.writer import DatasetWriter
from igrip.lab.simulation.minimum_jerk import reach

MESH = "cylinder:0.03x0.12"
PLACES = {"near": np.array([0.0, 0.25, 0.06]), "far": np.array([0.0, 0.5, 0.06])}


def shared_folder() -> Path | None:
    """Return the folder of the shared real data, beside the checkout, if it is there."""
    named = os.environ.get("IGRIP_SHARED_DATA")
    folder = Path(named) if named else Path(__file__).parents[2] / "shared" / "data"
    return folder if folder.is_dir() else None


def write_small_dataset(path: Path) -> Dataset:
    """Write two reaches, one to the near and one to the far cylinder, 1 s of rest before each."""
    writer = DatasetWriter(path, "Small", "MIT", "made by hand", objects=[MESH])
    upright = {"model": MESH, "orientation": [0, 0, 0, 1], "static": True}
    for number, (target, place) in enumerate(PLACES.items()):
        # the hand ends 5 cm before the object's surface
        points = reach(
            np.zeros(3), place - [0.0, 0.08, 0.0], 0.03, np.clip(np.arange(61) / 30 - 1.0, 0, 1)
        )
        objects = {id: {**upright, "position": p.tolist()} for id, p in PLACES.items()}
        messages = [
            Observation(
                t=k / 30,
                hands={"right": {"position": p.tolist()}},
                objects=objects if k == 0 else {},
            )
            for k, p in enumerate(points)
        ]
        trial = Trial(
            f"reach{number}", "p1", str(number), hand="right", target=target,
            onset_s=1.0, end_s=2.0, extra={"distance": target},
        )  # fmt: skip
        writer.add(trial, messages)
    return writer.close()
