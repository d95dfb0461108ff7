"""Simulated reaches for candidates end where they say."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.measure_grasps import declared_models
from igrip.grasps.candidate import CLEARANCE
from igrip.lab.simulation.grasp_reach import GraspReachConfig, draw_grasp_reach

EXACT = GraspReachConfig(noise=0.0, aim=0.0, turn_noise=0.0)


def test_the_palm_ends_where_the_candidate_has_it_above_the_table():
    rng = np.random.default_rng(0)
    models = declared_models()
    drawn = [draw_grasp_reach(models, rng, True, EXACT) for _ in range(20)]
    reaches = [reach for reach in drawn if reach is not None]
    assert len(reaches) >= 15
    for reach in reaches:
        last = reach.messages[-1].hands["right"]
        assert last.position == pytest.approx(reach.grasp.palm(CLEARANCE), abs=1e-9)
        assert last.position[2] > 0.0
        assert set(reach.messages[0].objects) == set(models)
        assert reach.onset < reach.at(0.5) < reach.end
        assert abs(reach.wrist) <= np.pi / 2


def test_the_same_seed_draws_the_same_reach():
    a, b = (draw_grasp_reach(declared_models(), np.random.default_rng(5)) for _ in range(2))
    assert [m.to_json() for m in a.messages] == [m.to_json() for m in b.messages]
