from pathlib import Path

import pytest

from igrip.config import Config
from igrip.lab.tuning.space import SPACE, first_candidates, is_upstream, values_of, with_values

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.parametrize("parameter", SPACE, ids=lambda p: p.key)
def test_each_number_is_documented_and_its_default_can_be_found(parameter):
    assert f"| `{parameter.key}` |" in (DOCS / "configuration.md").read_text(encoding="utf-8")
    assert f"| `{parameter.key}` |" in (DOCS / "tuning.md").read_text(encoding="utf-8")
    default = values_of(Config())[parameter.key]
    assert parameter.low <= default <= parameter.high
    steps = (default - parameter.low) / parameter.step
    assert steps == pytest.approx(round(steps))
    for bound in (parameter.low, parameter.high):  # the configuration accepts both
        assert values_of(with_values(Config(), {parameter.key: bound}))[parameter.key] == bound


def test_other_numbers_stay():
    base = Config(targets="paper", commitment={"assisted": ("left",)})
    changed = with_values(base, {"commitment.max_dwell": 0.4, "motion.reach.time_constant": 0.1})
    assert changed.commitment.max_dwell == 0.4
    assert changed.motion.reach.time_constant == 0.1
    assert with_values(changed, values_of(base)) == base


def test_searches_begin_with_what_is_there():
    config = Config(commitment={"reliability": 0.7})
    first, *others = first_candidates(config)
    assert with_values(config, first) == config
    assert all(with_values(config, one) != config for one in others)


def test_a_commitment_needs_no_new_replay():
    assert [p.key for p in SPACE if is_upstream(p.key)] == ["motion.reach.time_constant"]
