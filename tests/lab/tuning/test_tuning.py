"""Tuning people of whom it is known what is right for them."""

import math

import numpy as np
import pytest

pytest.importorskip("optuna", reason="the extra 'tune' is not installed")

from igrip.config import Config
from igrip.errors import IgripError
from igrip.lab.evaluation.calibration import interval_over_groups
from igrip.lab.tuning.outcomes import Outcomes
from igrip.lab.tuning.space import first_candidates, with_values
from igrip.lab.tuning.tuning import Tuning
from tuned_people import PRESENT, QUICK_SPACE, UNSURE, misleading, unsure, work_out

FIRST = first_candidates(Config(), QUICK_SPACE)


def tuned(replays, limit=30, groups=None, **options):
    groups = groups or [one.recording for one in replays]
    tuning = Tuning(work_out(replays), groups, QUICK_SPACE, FIRST, limit=limit, **options)
    for _ in tuning.run():
        pass
    return tuning, tuning.decide()


def test_a_lower_threshold_is_found_for_a_person_of_whom_the_estimator_is_never_sure():
    replays = unsure(20)
    _, decision = tuned(replays)
    assert decision.tuned
    assert not decision.present.committed.any()
    assert decision.interval[0] > 0.0
    assert with_values(Config(), decision.values).commitment.threshold <= UNSURE
    new = work_out(unsure(40, seed=1))(decision.values)  # the same person on another day
    assert new.committed.all()
    assert new.right.all()


def test_the_default_is_kept_for_a_person_for_whom_it_is_right():
    _, decision = tuned(misleading(16))
    assert not decision.tuned
    assert decision.values == PRESENT
    assert with_values(Config(), decision.values) == Config()


def test_the_default_is_kept_where_labels_mean_nothing():
    random = np.random.default_rng(0)
    replays = [one._replace(target=str(random.choice(["cup", "can"]))) for one in unsure(24)]
    _, decision = tuned(replays)
    assert not decision.tuned
    assert decision.values == PRESENT


def test_noise_alone_is_seldom_a_gain():
    """Candidates that differ from the present by chance alone: the interval is of 95 %."""
    shipped = 0
    for seed in range(40):

        def outcomes(values, seed=seed):
            random = np.random.default_rng([seed, int(1000 * values["commitment.reliability"])])
            parts = random.uniform(0.2, 0.8, 24)
            return Outcomes.of([(part, 1.0, math.nan, math.nan) for part in parts])

        groups = [str(k) for k in range(24)]
        tuning = Tuning(outcomes, groups, QUICK_SPACE, FIRST, seed=seed, limit=len(FIRST))
        for _ in tuning.run():
            pass
        shipped += tuning.decide().tuned
    assert shipped <= 5  # 97.5 % quantile of a binomial of 40 with 5 %: 5


def test_the_interval_covers_the_mean():
    random = np.random.default_rng(0)
    inside = 0
    for _ in range(200):
        low, high = interval_over_groups(random.normal(0.3, 1.0, 20), np.arange(20))
        inside += low <= 0.3 <= high
    assert 0.86 <= inside / 200 <= 0.99  # of 20 values, a percentile interval covers some 93 %


def test_a_choice_never_sees_the_participant_it_is_judged_on():
    people = [one._replace(participant=f"p{k % 4}") for k, one in enumerate(unsure(24))]
    groups = [one.participant for one in people]
    _, before = tuned(people, groups=groups, cohort=True)
    assert [{groups[k] for k in fold.trials} for fold in before.folds] == [
        {groups[fold.trials[0]]} for fold in before.folds
    ]
    assert {groups[fold.trials[0]] for fold in before.folds} == {"p0", "p1", "p2", "p3"}
    for name in ("p0", "p3"):
        strange = [one._replace(target="can") if one.participant == name else one for one in people]
        _, after = tuned(strange, groups=groups, cohort=True)
        [mine] = [k for k, fold in enumerate(before.folds) if groups[fold.trials[0]] == name]
        assert after.folds[mine] == before.folds[mine]
        assert after.folds != before.folds  # the others do see them


def test_what_the_outer_folds_object_to_is_not_shipped():
    """A fifth of the reaches go to the other object, which a low threshold gets wrong."""
    replays = [
        one._replace(target="can") if k % 5 == 0 else one for k, one in enumerate(unsure(20))
    ]
    _, decision = tuned(replays)
    assert not decision.tuned


def test_too_few_reaches_are_one_clear_error():
    with pytest.raises(IgripError, match="at least 8 reaches, there are 7"):
        tuned(unsure(7))
    with pytest.raises(IgripError, match="at least 3 people"):
        tuned(unsure(8), groups=["a", "b"] * 4, cohort=True)


def test_the_seed_decides():
    replays = unsure(12)
    runs = [tuned(replays, seed=seed)[0] for seed in (0, 0, 1)]
    one, same, other = ([search.candidates for search in run.searches] for run in runs)
    assert one == same
    assert one != other


def test_a_timeout_leaves_something_to_decide_on():
    tuning = Tuning(work_out(unsure(8)), list("abcdefgh"), QUICK_SPACE, FIRST, limit=30)
    assert list(tuning.run(timeout_s=0.0))[-1] == len(tuning.searches)
    assert not tuning.is_complete
    assert tuning.decide().values == PRESENT
