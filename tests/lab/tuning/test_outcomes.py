import math

import pytest

from igrip.commitment import CommitmentConfig
from igrip.lab.tuning.outcomes import Outcomes, outcome
from tuned_people import RATE, SECONDS, reach

CONFIG = CommitmentConfig()


def test_a_reach_is_judged_by_its_first_commitment():
    one = reach(0, lambda part: ("can", 0.9) if part < 0.5 else ("cup", 0.99))
    part, right, stated, false = outcome(one, CONFIG)
    assert part == pytest.approx(CONFIG.dwell / SECONDS, abs=1.0 / RATE / SECONDS)
    assert (right, stated) == (0.0, 0.9)
    assert math.isnan(false)
    assert outcome(one._replace(target="can"), CONFIG)[1] == 1.0
    part, right, stated, _ = outcome(one, CommitmentConfig(reliability=0.95, max_dwell=0.0))
    assert (part, right, stated) == (pytest.approx(0.5), 1.0, 0.99)


def test_a_reach_without_a_commitment():
    assert all(math.isnan(x) for x in outcome(reach(0, lambda part: ("cup", 0.4)), CONFIG))


def test_whoever_must_confirm_is_judged_as_if_they_did():
    one = reach(0, lambda part: ("cup", 0.9))
    asks = CONFIG.model_copy(update={"needs_confirmation": True})
    assert outcome(one, asks) == pytest.approx(outcome(one, CONFIG), nan_ok=True)


def test_scores_are_no_probabilities():
    one = reach(0, lambda part: ("cup", 0.9))
    for message in one.messages:
        del message.hands["right"].confidence["none"]
    assert math.isnan(outcome(one, CONFIG)[2])


def test_leases_without_a_reach_are_counted():
    one = reach(0, lambda part: ("cup", 0.9) if part < 0.4 else ("can", 0.9))
    idle = one._replace(target=None, bounds=None)
    assert outcome(idle, CONFIG)[3] == 2.0
    both = Outcomes.of([outcome(one, CONFIG), outcome(idle, CONFIG)])
    assert both.reaches.tolist() == [True, False]
    assert both.wrong().tolist() == [0.0, 2.0]
    assert outcome(idle, CommitmentConfig(reliability=1.0))[3] == 0.0
