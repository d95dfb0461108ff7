"""Plans: full crossing, seeded, within the limits, and saved for good."""

from __future__ import annotations

import tomllib
from collections import Counter
from itertools import groupby

import pytest

from igrip.experiment.plan import draw_plan, read_plan, save_plan
from igrip.experiment.study import Study, StudyError, template_text

PAPER = Study(**tomllib.loads(template_text("paper")))


@pytest.mark.parametrize("participant", ["P01", "P02", "P77"])
def test_every_combination_comes_as_often_as_any(participant):
    plan = draw_plan(PAPER, participant)
    counts = Counter(tuple(trial.levels.values()) for trial in plan.trials)
    assert len(counts) == 32
    assert set(counts.values()) == {4}
    for factor, most in PAPER.max_in_a_row.items():
        runs = [len(list(run)) for _, run in groupby(t.levels[factor] for t in plan.trials)]
        assert max(runs) <= most
    for block in range(4):
        part = plan.trials[32 * block : 32 * block + 32]
        assert len({tuple(trial.layout.items()) for trial in part}) == 1
        assert len(set(part[0].layout.values())) == len(PAPER.objects)


def test_the_order_is_that_of_the_seed_and_the_participant():
    orders = [
        [t.levels for t in draw_plan(study, person).trials]
        for study in (PAPER, PAPER.model_copy(update={"seed": 2})) for person in ("P01", "P02")
    ]  # fmt: skip
    assert orders[0] == [t.levels for t in draw_plan(PAPER, "P01").trials]
    assert all(a != b for k, a in enumerate(orders) for b in orders[:k])


def test_a_limit_that_no_order_keeps_is_refused():
    few = PAPER.model_copy(update={"factors": {**PAPER.factors, "hand": ("left",)},
                                   "max_in_a_row": {"hand": 2}})  # fmt: skip
    with pytest.raises(StudyError, match="max_in_a_row"):
        draw_plan(few, "P01")


def test_a_saved_plan_is_read_as_it_was(tmp_path):
    plan = draw_plan(PAPER, "P01")
    save_plan(plan, tmp_path / "plan.tsv")
    assert read_plan(tmp_path / "plan.tsv") == plan
    text = (tmp_path / "plan.tsv").read_text()
    cut, swapped = text[: text.index("\n50\t")], text.replace("\n7\t", "\n8\t")
    for damaged in (cut, text[:400], swapped, "", text.replace("plan/1", "x")):
        (tmp_path / "plan.tsv").write_text(damaged)
        with pytest.raises(StudyError, match="damaged"):
            read_plan(tmp_path / "plan.tsv")
