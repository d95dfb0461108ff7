"""Every number a user may change: named, bounded, documented, frozen."""

from __future__ import annotations

import importlib
import math
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from pydantic import BaseModel, ValidationError

from igrip import Config
from igrip.errors import UnknownNameError
from igrip.settings import RENAMED, Settings


def numbers(settings: BaseModel, path=""):
    """Yield path, field and default of every number in a configuration."""
    for name, field in type(settings).model_fields.items():
        default = getattr(settings, name)
        if isinstance(default, BaseModel):
            yield from numbers(default, f"{path}{name}.")
        elif isinstance(default, int | float) and not isinstance(default, bool):
            yield f"{path}{name}", field, default


NUMBERS = list(numbers(Config()))


@pytest.mark.parametrize(("path", "field", "default"), NUMBERS, ids=[row[0] for row in NUMBERS])
def test_every_number_has_unit_meaning_source_and_bounds(path, field, default):
    assert field.json_schema_extra["unit"]
    assert field.json_schema_extra["source"], f"{path} does not say where {default} comes from"
    assert field.description.endswith(f"[{field.json_schema_extra['unit']}]")
    assert field.metadata, f"{path} has no bounds"
    for value in (float("nan"), float("inf"), -1e9, -1e-9, "much", None):
        with pytest.raises(ValidationError):
            nested(path, value)


@pytest.mark.parametrize(("path", "field", "default"), NUMBERS, ids=[row[0] for row in NUMBERS])
def test_a_default_lies_within_its_own_bounds(path, field, default):
    """pydantic does not check it."""
    nested(path, default)


LIMITS = [
    ("motion.window", 3, 1000, 2, 1001),
    ("motion.future_points", 1, 100, 0, 101),
    ("motion.reach.rest_speed_fraction", 0.0, 0.999, None, 1.0),
    ("rays.rays_per_cone", 1, 1000, 0, 1001),
    ("rays.slow_angle", 1e-6, 1.499, 0.0, 1.5),
    ("rays.fast_angle", 1e-6, 1.499, 0.0, 1.5),
    ("commitment.reliability", 0.0, 1.0, None, 1.001),
    ("commitment.min_threshold", 1e-6, 0.999, 0.0, 1.0),
    ("commitment.max_threshold", 1e-6, 1.0, 0.0, 1.001),
    ("commitment.hysteresis", 0.0, 0.999, None, 1.0),
    ("tracking.max_hands", 1, 10_000, 0, None),
    ("tracking.max_objects", 1, 10_000, 0, None),
]


@pytest.mark.parametrize(("path", "lowest", "highest", "below", "above"), LIMITS)
def test_limits_of_counts_angles_and_parts(path, lowest, highest, below, above):
    for value in (lowest, highest):
        nested(path, value)
    for value in (below, above):
        if value is not None:
            with pytest.raises(ValidationError):
                nested(path, value)


POSITIVE = {path for path, field, _ in NUMBERS if any(hasattr(m, "gt") for m in field.metadata)}


@pytest.mark.parametrize(("path", "field", "default"), NUMBERS, ids=[row[0] for row in NUMBERS])
def test_small_numbers_are_allowed_and_zero_unless_it_would_divide(path, field, default):
    if isinstance(default, int) or path == "rays.fast_speed":  # not below slow_speed
        return
    if path == "grip.sure":  # of two grips the likelier has 0.5 and more
        with pytest.raises(ValidationError):
            nested(path, 0.49)
        return
    nested(path, 1e-6)
    if path in POSITIVE:
        with pytest.raises(ValidationError):
            nested(path, 0.0)
    else:
        nested(path, 0.0)


def test_the_documentation_has_every_number_and_its_default():
    """docs/configuration.md is made by docs/make_configuration.py."""
    lines = (Path(__file__).parents[1] / "docs" / "configuration.md").read_text().splitlines()
    rows = [
        [cell.strip() for cell in line.split(" | ")] for line in lines if line.startswith("| `")
    ]
    documented = {row[0].strip("|` "): float(row[1]) for row in rows}
    assert documented == {path: pytest.approx(default, rel=1e-4) for path, _, default in NUMBERS}


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


EDGES = (
    "perception.poses.depth", "perception.poses.tags", "perception.poses.cosypose",
    "perception.hands.mediapipe", "perception.hands._palms", "perception.calibration.extrinsics",
    "lab.rendering.layout", "lab.rendering.stereo",
)  # fmt: skip


@pytest.mark.parametrize("cls", RENAMED)
def test_an_old_key_raises_an_error_that_names_the_new_one(cls):
    for module in EDGES:
        importlib.import_module(f"igrip.{module}")
    [settings] = [c for c in every_settings(Settings) if c.__name__ == cls]
    for old, new in RENAMED[cls].items():
        assert new in settings.model_fields
        with pytest.raises(ValidationError, match=f"{old} was renamed to {new}"):
            settings(**{old: 1})


def every_settings(cls):
    """Return all subclasses, also those of subclasses."""
    return {cls}.union(*(every_settings(below) for below in cls.__subclasses__()))


def test_an_old_key_deep_inside_is_named_with_its_place():
    with pytest.raises(ValidationError, match="health was renamed to gating"):
        Config(health={"hand_limit": 0.5})
    with pytest.raises(ValidationError) as caught:
        Config(motion={"reach": {"calm": 0.2}})
    [error] = caught.value.errors()
    assert error["loc"] == ("motion", "reach")
    assert "calm was renamed to end_time_constant" in error["msg"]


def test_a_misspelt_key_is_answered_with_the_one_that_was_meant():
    with pytest.raises(ValidationError, match=r"no 'comitment'.*'commitment'"):
        Config(comitment={})
    with pytest.raises(ValidationError) as caught:
        Config(motion={"reach": {"onset_distanse": 0.01}})
    [error] = caught.value.errors()
    assert error["loc"] == ("motion", "reach")
    assert "'onset_distance'" in error["msg"]
    with pytest.raises(ValidationError, match="no 'zzz'; there are: targets, grips"):
        Config(zzz=1)


@pytest.mark.parametrize(("field", "wrong", "right"), [
    ("targets", "bayse", "bayes"), ("grips", "contcat", "contact"),
])  # fmt: skip
def test_a_misspelt_name_fails_when_the_configuration_is_made(field, wrong, right):
    with pytest.raises(UnknownNameError, match=f"'{wrong}' .did you mean '{right}'"):
        Config(**{field: wrong})


def test_a_configuration_imports_no_targets_estimator():
    script = "import igrip, sys; igrip.Config(); print('igrip.targets.bayes' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "False"
