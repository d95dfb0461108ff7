"""Real reaches of people that were not learned from: earlier and surer than the paper's method."""

from __future__ import annotations

import numpy as np
import pytest

import igrip
from datasets import shared_folder
from igrip.io.resampling import ImportOptions, resample
from training.people import KEPT_BACK, fold, real_reaches

EACH = 60  # of near and of far reaches


@pytest.fixture(scope="module")
def reaches():
    folder = shared_folder()
    if folder is None or not (folder / "wispinski2021").exists():
        pytest.skip("the shared data is not beside the checkout")
    kept = [r for r in real_reaches(folder / "wispinski2021") if fold(r.participant) == KEPT_BACK]
    parts = [[r for r in kept if r.extra["distance"] == d] for d in ("near", "far")]
    return [part[k * len(part) // EACH] for part in parts for k in range(EACH)]


def right(reaches, catalog, targets, rate=30.0):
    """Return whether the newest answer was right at 40, 60 and 100 %, shape (n, 3); and answers."""
    options = ImportOptions(noise=0.004, rate=rate)
    flags, every = [], []
    for reach in reaches:
        estimator = igrip.Estimator(catalog, igrip.Config(targets=targets))
        told = [i for m in resample(reach, catalog, options) for i in estimator.update(m)]
        ends = np.array([0.4, 0.6, 1.0]) * reach.times[-1]
        newest = [[i for i in told if i.t <= end + 1e-9][-1] for end in ends]
        flags.append([i.target == reach.target for i in newest])
        every += [(i.probability, reach.target) for i in told if i.probability]
    return np.array(flags), every


def test_near_and_far_are_told_apart_earlier_than_by_the_paper(reaches, ycb):
    mine, answers = right(reaches, ycb, "bayes")
    papers, _ = right(reaches, ycb, "paper")
    assert mine[:EACH, 2].mean() > 0.95  # near, at the end
    assert mine[EACH:, 2].mean() > 0.95  # far
    assert mine[:, 1].mean() > papers[:, 1].mean() + 0.1
    assert min(mine[:EACH, 0].mean(), mine[EACH:, 0].mean()) > 0.6
    likely = [(max(p.values()), max(p, key=p.get) == target) for p, target in answers]
    sure = np.array([hit for stated, hit in likely if stated > 0.9])
    assert sure.mean() > 0.9


@pytest.mark.parametrize("rate", [60.0, 120.0])
def test_a_faster_sensor_changes_little(reaches, ycb, rate):
    some = reaches[::2]
    usual, _ = right(some, ycb, "bayes")
    faster, _ = right(some, ycb, "bayes", rate)
    assert abs(faster.mean() - usual.mean()) < 0.06  # of 60 reaches; all: docs/estimators-tables.md
