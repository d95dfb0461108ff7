"""Train what ships: scorer, familiarity, times, the field's methods, the grip.

Example: python -m training shared-data --check
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from igrip.grips.contact import WEIGHTS as CONTACT
from igrip.targets.bayes import WEIGHTS
from igrip.targets.learned.familiarity import FILE as FAMILIARITY
from igrip.targets.learned.familiarity import read_movements
from igrip.targets.learned.network import read_scorer
from igrip.targets.learned.reach_library import LIBRARY
from igrip.targets.learned.timing import FILE as TIMING
from igrip.targets.learned.timing import read_timing
from training.familiarity import fit_familiarity, write_familiarity
from training.grip import fit_grip, write_grip
from training.learn import fit_scorer, inputs_of, probabilities, write_scorer
from training.library import fit_library, write_library
from training.moments import Moments, joined, thinned
from training.sources import SEED, Part, gather, kind_of, provenance, source_weight
from training.timing import fit_timing, write_timing

MEMORY = 0.02  # s; docs/estimators.md has the alternatives
NONE = 0.75  # weight of moments without a target (docs/estimators.md)


def weighted(parts: Mapping[str, Part]) -> Moments:
    """Return the moments of several sources as one, each with its weight."""
    moments = []
    for name, part in parts.items():
        one = thinned(part.moments, SEED)
        weight = source_weight(name, list(parts)) / one.weight.sum()
        moments.append(replace(one, weight=one.weight * weight))
    every = joined(moments)
    weight = every.weight / every.weight.mean()
    return replace(every, weight=np.where(every.target < 0, NONE, 1.0) * weight)


def main() -> int:
    """Train, and write or compare."""
    parser = argparse.ArgumentParser(
        prog="python -m training", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("shared", type=Path, help="folder with wispinski2021 and hands_at_work")
    parser.add_argument("--cache", type=Path, help="file that keeps what was gathered")
    parser.add_argument(
        "--check", action="store_true", help="compare with what ships, write nothing"
    )
    asked = parser.parse_args()
    began = time.monotonic()
    parts = gather(asked.shared, asked.cache)
    moments = weighted(parts)
    demonstrations = [d for part in parts.values() for d in part.demonstrations]
    scorer, loss = fit_scorer(moments, MEMORY, SEED)
    real = joined([part.moments for name, part in parts.items() if kind_of(name) == "near_far"])
    familiar = fit_familiarity(thinned(real, SEED))
    timing = fit_timing([p.timing for p in parts.values()], SEED)
    learned = fit_library(demonstrations, SEED)
    grip = fit_grip([a for part in parts.values() for a in part.approaches])
    print(
        f"{len(moments.target)} moments, loss {loss:.4f}; {len(demonstrations)} demonstrations; "
        f"{time.monotonic() - began:.0f} s",
        file=sys.stderr,
    )
    if asked.check:
        inputs, frame = inputs_of(moments), moments.frame
        ours, shipped = (probabilities(s, inputs, frame) for s in (scorer, read_scorer(WEIGHTS)))
        off = float(np.abs(ours - shipped).max())
        print(f"scorer: largest difference of a probability {off:.3g}")
        there = json.loads(LIBRARY.read_text(encoding="utf-8"))
        grips = json.loads(CONTACT.read_text(encoding="utf-8"))["weights"]
        apart = max(
            _apart(learned, {key: there[key] for key in learned}), _apart(grip, grips),
            _apart(timing._asdict(), read_timing(TIMING)._asdict()),
            _apart(familiar._asdict(), read_movements(FAMILIARITY)._asdict()),
        )  # fmt: skip
        print(f"the rest: largest difference of a number {apart:.3g}")
        return int(not (off <= 1e-6 and apart <= 1e-6))
    source = provenance(asked.shared)
    write_scorer(replace(scorer, provenance=source | {"loss": round(loss, 4)}), WEIGHTS)
    write_familiarity(familiar, source, FAMILIARITY)
    write_timing(timing, source, TIMING)
    write_library({**learned, "provenance": source}, LIBRARY)
    write_grip(grip, source, CONTACT)
    return 0


def _apart(a: Any, b: Any) -> float:
    """Return the largest difference between two nests of numbers."""
    if isinstance(a, dict):
        return max(_apart(a[key], b[key]) for key in a)
    if isinstance(a, str):
        return 0.0 if a == b else float("inf")
    return float(np.abs(np.array(a) - np.array(b)).max())


if __name__ == "__main__":
    sys.exit(main())
