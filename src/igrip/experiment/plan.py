"""The order of one participant's trials: drawn once, saved, and read from then on."""

from __future__ import annotations

import csv
import io
import json
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from igrip.experiment.study import Study, StudyError
from igrip.io.whole_files import write_whole

ATTEMPTS = 1000  # to find an order
FORMAT = "igrip-plan/1"


@dataclass(frozen=True)
class PlannedTrial:
    """One trial.

    Attributes
    ----------
    number : int
        In the order of the plan, from 1.
    levels : mapping of str to str
        Level of each factor.
    layout : mapping of str to str
        Place of each object.
    """

    number: int
    levels: Mapping[str, str]
    layout: Mapping[str, str]


@dataclass(frozen=True)
class Plan:
    """All trials of a participant, in order."""

    participant: str
    trials: Sequence[PlannedTrial]


def draw_plan(study: Study, participant: str) -> Plan:
    """Draw the order of the trials and the layouts from the study's seed and the participant.

    Every combination of levels comes ``repetitions`` times. Within the limits of
    ``max_in_a_row``, each next trial is drawn from those that are left.

    Raises
    ------
    StudyError
        If no order keeps to the limits.
    """
    random = np.random.default_rng([study.seed, zlib.crc32(participant.encode())])
    for _ in range(ATTEMPTS):
        order = _draw_order(study, random)
        if order is not None:
            break
    else:
        raise StudyError(
            f"max_in_a_row: none of {ATTEMPTS} orders keeps to it; allow more in a row"
        )
    trials, layout = [], {}
    places = list(study.layouts.places)
    for k, levels in enumerate(order):
        if k % study.layouts.change_every == 0:
            drawn = random.permutation(len(places))[: len(study.objects)]
            layout = {id: places[j] for id, j in zip(study.objects, drawn, strict=True)}
        trials.append(PlannedTrial(k + 1, levels, layout))
    return Plan(participant, tuple(trials))


def _draw_order(study: Study, random: np.random.Generator) -> list[dict[str, str]] | None:
    """Draw an order; None where it ends in a dead end."""
    combinations = study.combinations()
    left = np.full(len(combinations), study.repetitions)
    order: list[dict[str, str]] = []
    runs: Counter[str] = Counter()
    while left.any():
        allowed = np.array([
            all(
                runs[factor] < most or combination[factor] != order[-1][factor]
                for factor, most in study.max_in_a_row.items()
            )
            for combination in combinations
        ])  # fmt: skip
        weight = left * allowed
        if not weight.any():
            return None
        k = int(random.choice(len(left), p=weight / weight.sum()))
        left[k] -= 1
        for factor in study.max_in_a_row:
            same = bool(order) and order[-1][factor] == combinations[k][factor]
            runs[factor] = runs[factor] + 1 if same else 1
        order.append(combinations[k])
    return order


def save_plan(plan: Plan, path: Path) -> None:
    """Write a plan as a table: a line for each trial, cells separated by tabs."""
    text = io.StringIO()
    factors, objects = list(plan.trials[0].levels), list(plan.trials[0].layout)
    writer = csv.writer(text, delimiter="\t", lineterminator="\n")
    writer.writerow(["trial", *factors, *(f"place_of_{id}" for id in objects)])
    for trial in plan.trials:
        writer.writerow([trial.number, *trial.levels.values(), *trial.layout.values()])
    head = json.dumps(
        {"format": FORMAT, "participant": plan.participant, "trials": len(plan.trials)}
    )
    write_whole(path, f"# {head}\n{text.getvalue()}")


def read_plan(path: Path) -> Plan:
    """Read a saved plan.

    Raises
    ------
    StudyError
        If it is none, or damaged; the message names the line.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        head = json.loads(lines[0].removeprefix("# "))
        if head["format"] != FORMAT:
            raise ValueError
        rows = list(csv.reader(lines[1:], delimiter="\t"))
        columns = rows[0]
        trials = []
        for k, row in enumerate(rows[1:], start=1):
            cells = dict(zip(columns, row, strict=True))
            if int(cells.pop("trial")) != k:
                raise ValueError
            layout = {
                name.removeprefix("place_of_"): cells.pop(name)
                for name in columns if name.startswith("place_of_")
            }  # fmt: skip
            trials.append(PlannedTrial(k, cells, layout))
        if len(trials) != head["trials"]:
            raise ValueError
        return Plan(str(head["participant"]), tuple(trials))
    except OSError as error:
        raise StudyError(f"{path}: {error.strerror or error}") from error
    except (ValueError, KeyError, IndexError, TypeError):
        raise StudyError(
            f"{path}: is damaged; restore it from a backup: a new one would be another order"
        ) from None
