"""The sizes of effect that the documentation states, measured on what the people do."""

import numpy as np
import pytest

from igrip.lab.simulation.cohort import perform, tasks_of
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.lab.simulation.table import models_by_id


def kinematics(ycb, profile, people=40, trials=12):
    """Return movement time, peak speed over length and path ratio of some reaches, (n, 3)."""
    parameters, models, rows = cohort_parameters(profile), models_by_id(ycb), []
    for p in range(people):
        random = np.random.default_rng([9, p])
        habits = draw_habits(parameters.person, random)
        for task in tasks_of(parameters.protocol, random)[:trials]:
            done = perform(task, parameters, habits, models, random)
            onset, end = done.bounds
            path = done.palms[task.hand]
            length = np.linalg.norm(path[-1] - path[0])
            moving = (done.times >= onset - 0.05) & (done.times <= end + 0.05)
            steps = np.linalg.norm(np.diff(path[moving], axis=0), axis=1)
            rows.append((end - onset, steps.max() * 30 / length, steps.sum() / length))
    return np.array(rows)


def test_stroke_against_healthy(ycb):
    """In sd of the healthy: stated in docs/evaluation.md, with what was aimed at."""
    healthy, stroke = kinematics(ycb, "healthy"), kinematics(ycb, "stroke")
    effect = (stroke.mean(axis=0) - healthy.mean(axis=0)) / healthy.std(axis=0)
    assert effect == pytest.approx([2.7, -0.8, 0.4], abs=0.15)
