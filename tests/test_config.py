"""Every number a user may change: named, bounded, documented, frozen."""

from __future__ import annotations

import math
import pickle

import pytest
from pydantic import BaseModel, ValidationError

from igrip import Config


def numbers(model: type[BaseModel], path=""):
    """Yield path, field and default of every number in a configuration."""
    for name, field in model.model_fields.items():
        default = field.get_default(call_default_factory=True)
        if isinstance(default, BaseModel):
            yield from numbers(type(default), f"{path}{name}.")
        elif isinstance(default, int | float) and not isinstance(default, bool):
            yield f"{path}{name}", field, default


NUMBERS = list(numbers(Config))


@pytest.mark.parametrize(("path", "field", "default"), NUMBERS, ids=[row[0] for row in NUMBERS])
def test_every_number_has_unit_meaning_source_and_bounds(path, field, default):
    assert field.json_schema_extra["unit"]
    assert field.json_schema_extra["source"], f"{path} does not say where {default} comes from"
    assert field.description.endswith(f"[{field.json_schema_extra['unit']}]")
    assert field.metadata, f"{path} has no bounds"
    for value in (float("nan"), float("inf"), -1e9, "much", None):
        with pytest.raises(ValidationError):
            nested(path, value)


def nested(path, value):
    for name in reversed(path.split(".")):
        value = {name: value}
    return Config(**value)


def test_there_are_many():
    assert len(NUMBERS) > 30


@pytest.mark.parametrize("path", ["target", "motion.windows", "rays.ray", "cues.distance_", "x.y"])
def test_a_misspelt_name_is_an_error(path):
    with pytest.raises(ValidationError):
        nested(path, 1)


def test_it_is_frozen():
    config = Config()
    with pytest.raises(ValidationError):
        config.targets = "paper"
    with pytest.raises(ValidationError):
        config.motion.window = 5


def test_round_trips():
    config = Config(targets="paper", motion={"window": 10}, cues={"distance": "surface"})
    assert Config(**config.model_dump()) == config
    assert Config.model_validate_json(config.model_dump_json()) == config
    assert pickle.loads(pickle.dumps(config)) == config
    assert config != Config()
    assert config.motion.horizon == Config().motion.horizon


def test_the_numbers_of_the_specification():
    config = Config()
    assert config.motion.window == 20
    assert (config.motion.future_points, config.motion.horizon) == (10, 0.3)
    assert config.grip.pinch_threshold == 0.85
    assert (config.gating.max_hand_age, config.gating.max_object_age) == (0.3, 2.0)
    assert config.gating.restart_after == 0.3
    assert config.cues.distance == "vertex"
    assert 1.0 <= config.motion.filter.min_cutoff <= 1.5
    assert 2.0 <= config.motion.filter.beta <= 8.0
    assert config.motion.filter.derivative_cutoff == 1.0
    assert math.degrees(config.rays.slow_angle) == pytest.approx(25.0)
    assert math.degrees(config.rays.fast_angle) == pytest.approx(8.0)
    assert (config.rays.slow_speed, config.rays.fast_speed) == (0.03, 0.8)


@pytest.mark.parametrize(("slow", "fast"), [(0.5, 0.5), (0.9, 0.3)])
def test_the_ends_of_the_cone_must_be_in_order(slow, fast):
    """With equal speeds the interpolation of the angle would divide zero by zero."""
    with pytest.raises(ValidationError):
        Config(rays={"slow_speed": slow, "fast_speed": fast})
