"""What tuning leaves behind: configurations, and a record of how they came about."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from igrip.config import Config
from igrip.io.config_file import changed_values, config_text
from igrip.lab.tuning import objective
from igrip.lab.tuning.front import front, point
from igrip.lab.tuning.outcomes import Replay
from igrip.lab.tuning.replays import Unusable
from igrip.lab.tuning.space import SPACE, Values, values_of, with_values
from igrip.lab.tuning.tuning import Decision, Tuning
from igrip.version import __version__

SCHEMA = "igrip-tune/1"


class Subject(NamedTuple):
    """Whose configuration it is.

    Attributes
    ----------
    dataset : str
        Name of the dataset.
    participants : sequence of str
        The person, or the people of a cohort.
    usable, unusable : sequences
        Their trials.
    config : Config
        What they have at present.
    seed : int
        Of the tuning.
    """

    dataset: str
    participants: Sequence[str]
    usable: Sequence[Replay]
    unusable: Sequence[Unusable]
    config: Config
    seed: int

    @property
    def idle_minutes(self) -> float:
        """Length of the recordings without a reach [min]."""
        return sum(one.seconds for one in self.usable if one.bounds is None) / 60.0


def record_of(subject: Subject, tuning: Tuning, decision: Decision) -> dict[str, Any]:
    """Return the record of a tuning as plain data; its keys are listed in ``docs/tuning.md``."""
    names, idle = [one.recording for one in subject.usable], subject.idle_minutes
    space = [parameter._asdict() for parameter in SPACE]
    return {
        "schema": SCHEMA, "igrip": __version__, "dataset": subject.dataset,
        "participants": list(subject.participants), "seed": subject.seed,
        "reaches": int(decision.present.reaches.sum()), "recordings": names,
        "unusable": [one._asdict() for one in subject.unusable],
        "tuned": decision.tuned, "reason": decision.reason, "values": decision.values,
        "found": decision.found, "gain": decision.gain, "gain_interval": list(decision.interval),
        "complete": tuning.is_complete, "candidates": [len(search) for search in tuning.searches],
        "present": point(values_of(subject.config), decision.present, idle)._asdict(),
        "unseen": point({}, decision.judged, idle)._asdict() | {"values": None},
        "folds": [
            {"recordings": [names[k] for k in fold.trials], "values": fold.values}
            for fold in decision.folds
        ],
        "front": [one._asdict() for one in front(tuning.table.known, idle)],
        "objective": {
            "min_right": objective.MIN_RIGHT, "late_value": objective.LATE_VALUE,
            "wrong_cost": objective.WRONG_COST, "stated_weight": objective.STATED_WEIGHT,
        },
        "space": space,
    }  # fmt: skip


def write_files(out: Path, subject: Subject, decision: Decision, record: Mapping[str, Any]) -> None:
    """Write ``config.toml``, ``tune.json`` and the configurations of the front to a folder."""
    people = ", ".join(subject.participants)
    head = [
        f"igrip tune: {people}; {record['reaches']} reaches of {subject.dataset}, "
        f"seed {subject.seed}",
        f"{'tuned' if decision.tuned else 'kept as it was'}: {decision.reason}",
    ]
    _write_config(out / "config.toml", subject.config, decision.values, head)
    (out / "front").mkdir(exist_ok=True)
    for old in (out / "front").glob("*.toml"):
        old.unlink()
    for number, one in enumerate(record["front"], 1):
        note = f"{people}: point {number} of the front, {describe_point(one)}"
        _write_config(out / "front" / f"{number:02d}.toml", subject.config, one["values"], [note])
    text = json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False, default=float)
    (out / "tune.json").write_text(text + "\n", encoding="utf-8")


def describe_point(one: Mapping[str, Any]) -> str:
    """Return what a point of the front does, in words."""
    right = "" if one["right"] is None else f", {100.0 * one['right']:.0f} % of them right"
    return (
        f"{100.0 * one['committed']:.0f} % committed{right}, "
        f"at {100.0 * one['part']:.0f} % of the movement"
    )


def _write_config(path: Path, config: Config, values: Values, head: Sequence[str]) -> None:
    default = values_of(Config())
    changed = changed_values(with_values(config, values)) | dict(values)
    notes = {
        key: f"default {default[key]:g}" for key in values
        if not math.isclose(values[key], default[key])
    }  # fmt: skip
    path.write_text(config_text(changed, notes, head), encoding="utf-8")
