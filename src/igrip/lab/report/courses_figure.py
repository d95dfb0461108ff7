"""The published Figure 6: the time courses of one trial, with an arrow at each k_target."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from igrip.lab.evaluation.recorded_trial import Bounds
from igrip.lab.evaluation.runner import TrialRun
from igrip.lab.evaluation.time_courses import (
    GRIP,
    GRIPS,
    SPEED,
    TARGET,
    Array,
    TimeCourses,
    time_courses,
)
from igrip.lab.evaluation.trials import score_trial
from igrip.lab.report.matplotlib_figure import new_figure
from igrip.targets import best_of

COLOURS = ("#e88c2e", "#2e78c2", "#b03a9c", "#7a6a3a", "#3aa0a8", "#808080", "#a0522d", "#5a5ad0")
TARGET_COLOUR = "#2ca02c"
GRIP_COLOURS = ("#5a82d8", "#d35ac0")
SCORES = ("impacts", "distance_derivative", "distance", "future_distance", "global")


def courses_of_trial(run: TrialRun) -> TimeCourses:
    """Return what the first estimator of a run answered for the hand of the task."""
    answers = run.estimators[0]
    own = [
        (intention, speed)
        for intention, speed in zip(answers.intentions, answers.speeds, strict=True)
        if intention.hand == run.trial.hand
    ]
    return time_courses([intention for intention, _ in own], [speed for _, speed in own])


def find_k_target(
    courses: TimeCourses, name: str, target: str | None, bounds: Bounds
) -> float | None:
    """Return when the longest run in which one score chooses the target begins [s]."""
    chosen = [best_of(column) for column in courses.panels[name].T]
    right = [o is not None and courses.objects[o] == target for o in chosen]
    return score_trial(courses.times, np.array(right, dtype=bool), *bounds).found


def draw_courses(run: TrialRun, bounds: Bounds) -> Any | None:
    """Draw eight panels: A speed, B-E confidences, F global (dashed: none), G target, H grip.

    Of the first estimator of a run, with onset and end [s]. None where the hand of the task was
    never measured.
    """
    courses, task = courses_of_trial(run), run.trial
    if not len(courses.times):
        return None
    figure = new_figure(7.0, 9.0, "the report")
    panels = figure.subplots(8, 1, sharex=True)
    onset, end = bounds
    t = courses.times - onset
    others = [id for id in courses.objects if id != task.target]
    colours = {id: COLOURS[k % len(COLOURS)] for k, id in enumerate(others)}
    if task.target:
        colours[task.target] = TARGET_COLOUR
    panels[0].plot(t, courses.panels[SPEED][0], color="black")
    panels[0].set_ylabel("speed\n[m/s]")
    for panel, name in zip(panels[1:6], SCORES, strict=True):
        panel.set_ylabel(name.replace("_", "\n"))
        if name not in courses.panels:
            continue
        for id, row in zip(courses.objects, courses.panels[name], strict=True):
            panel.plot(t, row, color=colours[id], label=id, lw=2 if id == task.target else 1)
        found = find_k_target(courses, name, task.target, bounds)
        if found is not None:
            panel.annotate(
                "", (found - onset, 0.02), (found - onset, -0.3),
                xycoords=("data", "axes fraction"),
                arrowprops={"arrowstyle": "-|>", "color": TARGET_COLOUR},
            )  # fmt: skip
    panels[5].plot(t, courses.none, color="black", lw=0.8, ls="--")
    _draw_marks(panels[6], t, courses.panels[TARGET], courses.objects, colours)
    panels[6].set_ylabel("target")
    _draw_marks(
        panels[7], t, courses.panels[GRIP], GRIPS, dict(zip(GRIPS, GRIP_COLOURS, strict=True))
    )
    panels[7].set_ylabel("grip")
    for letter, panel in zip("ABCDEFGH", panels, strict=True):
        panel.set_title(letter, loc="left", fontsize=9, fontweight="bold")
        for edge in (0.0, end - onset):
            panel.axvline(edge, color="grey", lw=0.8, ls=":")
        panel.tick_params(labelsize=7)
    panels[7].set_xlabel("time from movement onset [s]; dotted: onset and end")
    if courses.objects:
        lines, names = panels[5].get_legend_handles_labels()
        figure.legend(lines, names, loc="outside lower center", fontsize=7, ncols=4)
    figure.suptitle(
        f"{task.recording}: {task.hand} hand to {task.target}, {task.grip} grip\n"
        "green: the target; arrows: k_target; dashed: probability of none", fontsize=9,
    )  # fmt: skip
    return figure


def _draw_marks(
    panel: Any, t: Array, rows: Array, names: Sequence[str], colours: Mapping[str, str]
) -> None:
    """Draw answers as squares, one row a name."""
    for name, row in zip(names, rows, strict=True):
        panel.plot(t, row, "s", color=colours[name], ms=3)
    panel.set_yticks(range(1, len(names) + 1), names)
    panel.set_ylim(0.4, len(names) + 0.6)
