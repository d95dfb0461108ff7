"""Families of parts: found by name, and open to third parties."""

from __future__ import annotations

import importlib
import pickle
import sys
from collections import Counter

import numpy as np
import pytest

import igrip
from igrip.cues import CUES, Cue, CueConfig, cue
from igrip.errors import UnknownNameError
from igrip.grips import GRIPS, Grip
from igrip.io.recordings import SOURCES
from igrip.registry import Registry
from igrip.targets import TARGETS, TargetEstimate, best_of
from support import BOX, hand, message, pose, run, scene_of_shapes

METRICS = ("impacts", "distance_derivative", "distance", "future_distance")


def test_built_in_members():
    assert set(METRICS) <= set(CUES.names())
    assert {"paper", "repaired", *METRICS} <= set(TARGETS.names())
    assert "cylinder" in GRIPS.names()
    assert "jsonl" in SOURCES.names()
    assert CUES.names() == tuple(sorted(CUES.names()))
    for name in METRICS:
        assert CUES.get(name).name == name
    assert [CUES.get(name).order for name in METRICS] == [1, 1, 0, 0]


@pytest.mark.parametrize("registry", [CUES, TARGETS, GRIPS, SOURCES], ids=lambda r: r.family)
def test_unknown_names(registry):
    with pytest.raises(UnknownNameError) as raised:
        registry.get("no such thing")
    assert raised.value.family == registry.family
    assert raised.value.name == "no such thing"
    assert raised.value.choices == registry.names()
    for name in registry.names():
        assert name in str(raised.value)
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value)


@pytest.fixture
def registered(monkeypatch):
    """Register members for one test only."""

    def add(registry, name, member):
        registry.names()  # the built-in ones first
        monkeypatch.setitem(registry._members, name, member)

    return add


def test_a_third_party_cue(registered, shapes):
    """Registered under its name, and used by a third party's estimator of targets."""
    before = CUES.names()

    def nearness(motion, geometry, config: CueConfig):
        return np.exp(-geometry.surface / config.default_spread)

    made = Cue("nearness", 0, nearness)
    registered(CUES, "nearness", made)
    assert CUES.get("nearness") is made
    assert set(CUES.names()) == {*before, "nearness"}

    class Nearest:
        def update(self, motion, geometry, cues):
            scores = CUES.get("nearness").score(motion, geometry, CueConfig())
            return TargetEstimate(best_of(scores), scores)

    registered(TARGETS, "nearest", Nearest)
    told = run(scene_of_shapes(np.random.default_rng(1)), shapes, igrip.Config(targets="nearest"))
    answered = [intention for intention in told if intention.scores]
    assert answered
    for intention in answered:
        scores = {id: row["global"] for id, row in intention.scores.items()}
        told_too = {id: row["nearness"] for id, row in intention.scores.items()}
        assert scores == told_too  # it is reported beside the paper's four
        assert set(METRICS) < set(next(iter(intention.scores.values())))
        assert intention.target == max(scores, key=scores.get)
        assert intention.confidence == scores[intention.target]


def test_the_decorator_makes_and_registers_a_cue(monkeypatch):
    CUES.names()
    monkeypatch.setattr(CUES, "_members", dict(CUES._members))

    @cue("constant", order=1)
    def constant(motion, geometry, config):
        return np.ones(3)

    assert isinstance(constant, Cue)
    assert CUES.get("constant") is constant
    assert constant.order == 1
    assert constant.score(None, None, None).tolist() == [1.0, 1.0, 1.0]


def test_an_estimator_with_probabilities(registered, shapes):
    class Even:
        def update(self, motion, geometry, cues):
            count = len(geometry.objects)
            even = np.full(count + 1, 1.0 / (count + 1))
            return TargetEstimate(0, even[:-1], even)

    registered(TARGETS, "even", Even)
    told = run(scene_of_shapes(np.random.default_rng(1)), shapes, igrip.Config(targets="even"))
    intention = told[-1]
    assert list(intention.probability) == [*intention.scores, "none"]
    assert sum(intention.probability.values()) == pytest.approx(1.0)
    assert intention.confidence == pytest.approx(0.25)
    assert intention.target == next(iter(intention.scores))


class Counting:
    """Counts its updates in the score, so that it can be seen how long one instance lives."""

    def __init__(self):
        self.count = 0

    def update(self, motion, geometry, cues):
        self.count += 1
        return TargetEstimate(0, np.full(len(geometry.objects), float(self.count)))


def count_of(told):
    return [int(i.confidence) for i in told if i.confidence is not None]


def still(start, count, hands=("right",)):
    body = {"box": pose((0.3, 0.0, 0.0), model=BOX, static=True)}
    return [
        message(start + k / 30, {id: hand((0.001 * k, 0, 0)) for id in hands}, body)
        for k in range(count)
    ]


def test_one_instance_of_the_estimator_follows_one_hand(registered, shapes):
    registered(TARGETS, "counting", Counting)
    config = igrip.Config(targets="counting")
    assert count_of(run(still(1.0, 6), shapes, config)) == [1, 2, 3, 4]
    both = run(still(1.0, 6, hands=("left", "right")), shapes, config)
    for id in ("left", "right"):
        assert count_of(i for i in both if i.hand == id) == [1, 2, 3, 4]


def test_a_stream_that_begins_anew_gets_a_new_instance(registered, shapes):
    registered(TARGETS, "counting", Counting)
    told = run(still(1.0, 6) + still(3.0, 6), shapes, igrip.Config(targets="counting"))
    assert count_of(told) == [1, 2, 3, 4, 1, 2, 3, 4]


def test_a_hand_that_was_forgotten_gets_a_new_instance(registered, shapes):
    registered(TARGETS, "counting", Counting)
    config = igrip.Config(targets="counting", tracking={"max_hands": 1})
    messages = still(1.0, 6, ["a"]) + still(3.0, 6, ["b"]) + still(5.0, 6, ["a"])
    told = run(messages, shapes, config)
    assert count_of(i for i in told if i.hand == "a") == [1, 2, 3, 4, 1, 2, 3, 4]


def test_a_third_party_grip(registered, shapes):
    class Either:
        def __init__(self, config):
            self.pinch_threshold = config.pinch_threshold

        def select(self, belief, geometry, motion):
            return Grip("tripod", {"tripod": 0.7, "pinch": 0.3})

    registered(GRIPS, "either", Either)
    told = run(scene_of_shapes(np.random.default_rng(1)), shapes, igrip.Config(grips="either"))
    assert told[-1].grip == "tripod"
    assert told[-1].grip_probability == {"tripod": 0.7, "pinch": 0.3}


@pytest.fixture
def family(tmp_path, monkeypatch):
    """A package of members on disk, imported from there."""
    package = tmp_path / "some_family"
    package.mkdir()
    (package / "__init__.py").write_text(
        "from igrip.registry import Registry\nFAMILY = Registry('toy', 'some_family')\n"
    )
    (package / "one.py").write_text("from some_family import FAMILY\nFAMILY.register('one')(1)\n")
    (package / "_shared.py").write_text("raise ImportError('no member')\n")
    (package / "two.py").write_text("from some_family import FAMILY\nFAMILY.register('two')(2)\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield importlib.import_module("some_family").FAMILY
    for name in [name for name in sys.modules if name.startswith("some_family")]:
        del sys.modules[name]


def test_a_member_is_one_file(family):
    assert family.names() == ("one", "two")
    assert "some_family.one" not in sys.modules  # nothing is imported before it is asked for
    assert family.get("two") == 2
    assert "some_family.one" not in sys.modules


def test_a_module_that_registers_another_name(family, tmp_path):
    (tmp_path / "some_family" / "three.py").write_text("")
    assert family.names() == ("one", "three", "two")
    with pytest.raises(RuntimeError, match=r"some_family\.three does not register 'three'"):
        family.get("three")


def test_entry_points_add_members_and_never_replace_one(family, monkeypatch):
    class Point:
        def __init__(self, name, member):
            self.name, self.member = name, member

        def load(self):
            return self.member

    points = {"some_family": [Point("three", 3), Point("one", "other")]}
    monkeypatch.setattr("igrip.registry.entry_points", lambda group: points[group])
    assert family.get("three") == 3
    assert family.get("one") == 1


def test_discovery_happens_once(family, monkeypatch):
    asked = Counter()

    def points(group):
        asked[group] += 1
        return []

    monkeypatch.setattr("igrip.registry.entry_points", points)
    for _ in range(3):
        family.names()
    assert asked == {"some_family": 1}


def test_two_members_of_one_name():
    registry = Registry("toy", "igrip.cues")
    registry.register("x")(1)
    with pytest.raises(ValueError, match="toy named 'x'"):
        registry.register("x")(2)
    assert registry.register("x")(1) == 1  # the same again is no harm


def test_a_module_that_fails_is_heard_of_each_time(family, monkeypatch):
    def points(group):
        raise ImportError("broken plug-in")

    monkeypatch.setattr("igrip.registry.entry_points", points)
    for _ in range(2):
        with pytest.raises(ImportError, match="broken plug-in"):
            family.names()


def test_register_returns_the_member():
    registry = Registry("toy", "igrip.cues")
    member = object()
    assert registry.register("x")(member) is member
