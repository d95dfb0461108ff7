"""Messages that contradict earlier ones: an error that names the field, and nothing changed."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from igrip import Config, Estimator, Observation, ObservationError
from support import BOX, CAN, hand, lines, message, pose, run, scene_of_shapes

CONTRADICTIONS = {
    "time decreases": (lambda t: message(t - 0.001, {"right": hand((9, 9, 9))}), "t"),
    "a tick from the past": (lambda t: message(t / 2), "t"),
    "an id gets another model": (
        lambda t: message(t, {"right": hand((9, 9, 9))}, {"box": pose((5, 5, 5), model=CAN)}),
        "objects.box.model",
    ),
    "an id gets an unknown model": (
        lambda t: message(t + 1.0, None, {"can": pose((5, 5, 5), model="unheard of")}),
        "objects.can.model",
    ),
    "a new id without model": (
        lambda t: message(t, {"new hand": hand((0, 0, 0))}, {"new": pose((5, 5, 5))}),
        "objects.new.model",
    ),
    "good objects before and after the bad one": (
        lambda t: message(
            t + 1.0,
            {"right": hand((0.5, 0.5, 0.5)), "left": None},
            {
                "fresh": pose((1, 1, 1), model=BOX),
                "box": pose((0.4, 0.2, 0.1)),
                "new": pose((5, 5, 5)),
                "later": pose((2, 2, 2), model=BOX),
            },
        ),
        "objects.new.model",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_the_field_is_named(shapes, name):
    make, field = CONTRADICTIONS[name]
    messages = scene_of_shapes(np.random.default_rng(1))
    estimator = Estimator(shapes)
    run(messages, shapes, estimator=estimator)
    with pytest.raises(ObservationError) as raised:
        estimator.update(Observation(**make(messages[-1]["t"])))
    assert raised.value.field == field


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_it_goes_on_as_if_the_message_had_never_come(shapes, name):
    make, _ = CONTRADICTIONS[name]
    messages = scene_of_shapes(np.random.default_rng(2), moving=True)
    expected, estimator = Estimator(shapes), Estimator(shapes)
    seen_objects = next(k for k, m in enumerate(messages) if len(m.get("objects", {})) == 3)
    for k, plain in enumerate(messages):
        a = expected.update(Observation(**plain))
        b = estimator.update(Observation(**plain))
        assert lines(a) == lines(b)
        if k < seen_objects:
            continue
        report = str(estimator.inputs())
        with pytest.raises(ObservationError):
            estimator.update(Observation(**make(plain["t"])))
        assert str(estimator.inputs()) == report
    assert str(expected.inputs()) == str(estimator.inputs())
    assert (expected.scene.counters == estimator.scene.counters).all()


def test_equal_times_are_allowed(shapes):
    estimator = Estimator(shapes)
    for _ in range(3):
        estimator.update(Observation(t=1.0))
    estimator.update(Observation(t=1.0, hands={"right": hand((0, 0, 0))}))
    assert estimator.inputs()["counts"]["messages"] == 4


def test_the_same_model_again_is_no_rebinding(shapes):
    estimator = Estimator(shapes)
    for t in (1.0, 2.0):
        estimator.update(Observation(**message(t, None, {"box": pose((0, 0, 0), model=BOX)})))
    assert estimator.inputs()["objects"]["box"]["usable"]


def test_an_id_that_was_forgotten_may_be_bound_anew(shapes):
    estimator = Estimator(shapes, Config(tracking={"max_objects": 1}))
    estimator.update(Observation(**message(1.0, None, {"x": pose((0, 0, 0), model=BOX)})))
    estimator.update(Observation(**message(9.0, None, {"y": pose((0, 0, 0), model=BOX)})))
    estimator.update(Observation(**message(19.0, None, {"x": pose((0, 0, 0), model=CAN)})))
    assert estimator.inputs()["objects"]["x"]["model"] == CAN


def test_long_ids_do_not_make_long_errors(shapes):
    estimator = Estimator(shapes)
    with pytest.raises(ObservationError) as raised:
        estimator.update(Observation(**message(1.0, None, {"x" * 100_000: pose((0, 0, 0))})))
    assert len(str(raised.value)) < 300


ODD_IDS = [
    "a.b", "a.b.model", "a.", ".", "", " ", "a[0]", "a[0].model", "mug ☕", "\u200b", "a" * 81,
]  # fmt: skip


@pytest.mark.parametrize("id", ODD_IDS)
def test_the_refused_object_is_named_whatever_its_id(shapes, id):
    """Its id cannot be read off the field: dots are allowed, and long ids are shortened there."""
    others = {"a": pose((0.1, 0, 0), model=BOX), "a" * 82: pose((0.4, 0, 0), model=BOX)}
    estimator = Estimator(shapes)
    estimator.update(Observation(**message(1.0, None, others | {id: pose((0, 0, 1), model=BOX)})))
    rebound = others | {id: pose((0, 0, 1), model=CAN)}
    with pytest.raises(ObservationError) as raised:
        estimator.update(Observation(**message(1.1, None, rebound)))
    assert raised.value.object_id == id
    assert pickle.loads(pickle.dumps(raised.value)).object_id == id


def test_an_error_about_the_whole_message_names_no_object(shapes):
    estimator = Estimator(shapes)
    estimator.update(Observation(**message(1.0)))
    with pytest.raises(ObservationError) as raised:
        estimator.update(Observation(**message(0.5, None, {"t": pose((0, 0, 0), model=BOX)})))
    assert raised.value.object_id is None
