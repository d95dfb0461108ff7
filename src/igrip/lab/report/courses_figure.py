"""The paper's Figure 6: the time courses of one trial, with an arrow at each k_target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.config import Config
from igrip.estimator import Estimator
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.recordings import open_source
from igrip.lab.evaluation.trials import score_trial
from igrip.lab.report.matplotlib_figure import new_figure
from igrip.objects.catalog import Catalog
from igrip.targets import best_of

Array = NDArray[np.float64]
COLOURS = ("#e88c2e", "#2e78c2", "#b03a9c", "#7a6a3a", "#3aa0a8", "#808080", "#a0522d", "#5a5ad0")
TARGET = "#2ca02c"
SCORES = ("impacts", "distance_derivative", "distance", "future_distance", "global")


@dataclass(frozen=True)
class TrialCourse:
    """What an estimator said over one trial.

    Attributes
    ----------
    trial : Trial
        Its row.
    onset, end : float
        Of the movement [s].
    times, speeds : (n,)
        Of the answers for the task's hand [s, m/s].
    objects : tuple of str
        The objects, in the order of the scores.
    scores : dict of str to (objects, n)
        Each cue and the global score; NaN where there is none.
    targets, grips : list of str or None
        The answers.
    """

    trial: Trial
    onset: float
    end: float
    times: Array
    speeds: Array
    objects: tuple[str, ...]
    scores: dict[str, Array]
    targets: list[str | None]
    grips: list[str | None]


def follow_trial(
    dataset: Dataset, trial: Trial, catalog: Catalog, config: Config, bounds: tuple[float, float]
) -> TrialCourse:
    """Run an estimator over one trial again, and keep all it says of the task's hand."""
    estimator = Estimator(catalog, config)
    answers, speeds = [], []
    for observation in open_source(dataset.recording(trial)):
        for intention in estimator.update(observation):
            if intention.hand == trial.hand:
                motion = estimator.hands[intention.hand].motion
                answers.append(intention)
                speeds.append(np.nan if motion is None else motion.speed)
    objects = tuple(sorted({id for i in answers for id in i.scores}))
    scores = {
        name: np.array(
            [[i.scores.get(id, {}).get(name, np.nan) for i in answers] for id in objects]
        ).reshape(len(objects), len(answers))
        for name in SCORES
    }
    return TrialCourse(
        trial, *bounds, np.array([i.t for i in answers]), np.array(speeds), objects, scores,
        [i.target for i in answers], [i.grip for i in answers],
    )  # fmt: skip


def found_at(course: TrialCourse, name: str) -> float | None:
    """Return the k_target of one score as a time [s]: where its longest right run begins."""
    rows = course.scores[name]
    chosen = [best_of(rows[:, k]) for k in range(rows.shape[1])]
    right = np.array(
        [o is not None and course.objects[o] == course.trial.target for o in chosen], dtype=bool
    )
    return score_trial(course.times, right, course.onset, course.end).found


def draw_courses(course: TrialCourse) -> Any:
    """Draw eight panels: A speed, B-E confidences, F global, G target, H grip."""
    figure = new_figure(7.0, 9.0, "the report")
    panels = figure.subplots(8, 1, sharex=True)
    t = course.times - course.onset
    others = [id for id in course.objects if id != course.trial.target]
    colours = dict(zip(others, COLOURS * (1 + len(others) // len(COLOURS)), strict=False))
    if course.trial.target:
        colours[course.trial.target] = TARGET
    panels[0].plot(t, course.speeds, color="black")
    panels[0].set_ylabel("speed\n[m/s]")
    for panel, name in zip(panels[1:6], SCORES, strict=True):
        for id, row in zip(course.objects, course.scores[name], strict=True):
            panel.plot(
                t, row, color=colours[id], label=id, lw=2 if id == course.trial.target else 1
            )
        panel.set_ylabel(name.replace("_", "\n"))
        found = found_at(course, name)
        if found is not None:
            at = found - course.onset
            panel.annotate(
                "", (at, 0.02), (at, -0.3), xycoords=("data", "axes fraction"),
                arrowprops={"arrowstyle": "-|>", "color": TARGET},
            )  # fmt: skip
    _marks(panels[6], t, course.targets, course.objects, colours)
    panels[6].set_ylabel("target")
    grips = ("palmar", "pinch")
    _marks(panels[7], t, course.grips, grips, {"palmar": "#5a82d8", "pinch": "#d35ac0"})
    panels[7].set_ylabel("grip")
    for letter, panel in zip("ABCDEFGH", panels, strict=True):
        panel.set_title(letter, loc="left", fontsize=9, fontweight="bold")
        for edge in (0.0, course.end - course.onset):
            panel.axvline(edge, color="grey", lw=0.8, ls=":")
        panel.tick_params(labelsize=7)
    panels[7].set_xlabel("time from movement onset [s]; dotted: onset and end")
    panels[1].legend(loc="upper left", fontsize=7, ncols=4)
    task = course.trial
    figure.suptitle(
        f"{task.recording}: {task.hand} hand to {task.target}, {task.grip} grip "
        f"(green: the target; arrows: k_target)", fontsize=9,
    )  # fmt: skip
    return figure


def _marks(
    panel: Any, t: Array, said: list[str | None], names: tuple[str, ...], colours: dict[str, str]
) -> None:
    """Draw answers as squares, one row a name."""
    for row, name in enumerate(names):
        here = np.array([s == name for s in said], dtype=bool)
        panel.plot(t[here], np.full(here.sum(), row), "s", color=colours[name], ms=3)
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(-0.6, len(names) - 0.4)
