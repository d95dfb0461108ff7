"""Reach-to-grasp movements to a near or a far object (Wispinski et al. 2021).

Two tables: ``trials`` (trial, participant, target, near, position of both objects) and ``reaches``
(trial, seconds from onset, position of a marker on the index finger).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from igrip.io.importers import IMPORTERS, ImportFiles, ReachReader, RecordedReach

_TRIALS = {
    "trial", "participant", "start_pad", "target", "near", "block",
    "left_x", "left_y", "left_z", "right_x", "right_y", "right_z",
}  # fmt: skip
_REACHES = {"trial", "t", "x", "y", "z"}


class Wispinski2021:
    """Importer of these two tables."""

    name = "Near/far reaches (Wispinski et al. 2021)"
    license = "BSD-3-Clause"
    source = (
        "Wispinski, Stone, Bertrand, Ouellette Zuk, Lavoie, Gallivan & Chapman (2021), Attention, "
        "Perception & Psychophysics 83:122-132. A marker on the index finger, not the palm; the "
        "hand is not recorded and called 'right'. Objects have a position, no orientation or shape."
    )

    def recognises(self, files: ImportFiles) -> bool:
        """Return whether there are a table of trials and one of reaches with these columns."""
        tables = files.tables
        return (
            {"trials", "reaches"} <= tables.keys()
            and set(tables["trials"].columns) >= _TRIALS
            and set(tables["reaches"].columns) >= _REACHES
        )

    def reaches(self, files: ImportFiles) -> Sequence[ReachReader]:
        """Return one function per trial, in the order of the table."""
        trials = files.tables["trials"]
        samples = files.tables["reaches"].sort_values(["trial", "t"], kind="stable")
        numbers = samples["trial"].to_numpy()
        values = samples[["t", "x", "y", "z"]].to_numpy(dtype=np.float64)
        rows = trials.to_dict("records")

        def reader(row: Mapping[Any, Any]) -> ReachReader:
            def read() -> RecordedReach:
                first = np.searchsorted(numbers, row["trial"], side="left")
                last = np.searchsorted(numbers, row["trial"], side="right")
                part = values[first:last]
                return RecordedReach(
                    name=f"{row['participant']}_{int(row['trial']):05d}",
                    participant=str(row["participant"]),
                    trial=str(row["trial"]),
                    hand="right",
                    target=str(row["target"]),
                    times=part[:, 0] - part[:1, 0],
                    positions=part[:, 1:],
                    object_positions={
                        side: np.array([row[f"{side}_{axis}"] for axis in "xyz"], dtype=np.float64)
                        for side in ("left", "right")
                    },
                    extra={
                        "distance": "near" if row["near"] else "far",
                        "start_pad": str(row["start_pad"]),
                        "block": str(row["block"]),
                    },
                )

            return read

        return [reader(row) for row in rows]


IMPORTERS.register("wispinski2021")(Wispinski2021())
