"""What is told of one hand, and its way to JSON and back."""

from __future__ import annotations

import json

import numpy as np
import pytest

import igrip
from igrip import Intention
from igrip.intention import Commitment
from support import hand, message, run, scene_of_shapes

FULL = Intention(
    t=1.5,
    hand="right",
    status="reaching",
    reason="because",
    target="mustard",
    target_model="006_mustard_bottle",
    confidence=0.8,
    grip="palmar",
    grip_probability={"palmar": 0.9, "pinch": 0.1},
    time_to_contact=0.4,
    time_to_contact_interval=(0.3, 0.6),
    time_to_end=0.5,
    time_to_end_interval=(0.4, 0.8),
    familiarity=0.5,
    contact=(0.1, 0.2, 0.3),
    aperture=0.06,
    wrist=0.3,
    wrist_std=0.1,
    probability={"mustard": 0.8, "none": 0.2},
    scores={"mustard": {"impacts": 0.5, "global": 0.6}},
    commitment=Commitment(target="mustard", grip="palmar", since=1.2, valid_until=1.65),
)


@pytest.mark.parametrize("intention", [FULL, Intention(t=0.0, hand="x", status="lost")])
def test_json_and_back(intention):
    assert Intention.from_json(intention.to_json()) == intention
    assert json.loads(intention.to_json()) == json.loads(json.dumps(intention.to_dict()))
    assert next(iter(json.loads(intention.to_json()))) == "schema"
    assert b"\n" not in intention.to_json()


def test_those_of_an_estimator_survive_to_the_last_bit(shapes):
    told = run(scene_of_shapes(np.random.default_rng(1)), shapes)
    assert any(intention.contact for intention in told)
    for intention in told:
        again = Intention.from_json(intention.to_json())
        assert again == intention
        assert again.to_json() == intention.to_json()


@pytest.mark.parametrize(
    "line", [b"", b"{}", b'{"t":1,"hand":"x"}', b'{"t":1,"hand":"x","status":"flying"}', b"[1]"]
)
def test_what_is_no_intention(line):
    with pytest.raises(igrip.ObservationError):
        Intention.from_json(line)


def test_it_is_immutable():
    with pytest.raises(AttributeError):
        FULL.target = "soup"


def test_the_published_schema_describes_what_is_written():
    schema = Intention.json_schema()["$defs"]["Intention"]
    assert set(json.loads(FULL.to_json())) == set(schema["properties"])
    assert set(schema["required"]) == {"t", "hand", "status"}


def test_the_form_of_the_design():
    """Every key of an intention as docs/schemas/intention.json publishes it is there."""
    keys = {
        "schema", "t", "hand", "status", "reason", "target", "target_model", "confidence", "grip",
        "grip_probability", "time_to_contact", "contact", "probability", "scores", "commitment",
        "familiarity", "time_to_contact_interval", "time_to_end", "time_to_end_interval",
        "aperture", "wrist", "wrist_std",
    }  # fmt: skip
    assert set(json.loads(FULL.to_json())) == keys


def test_a_hand_id_that_cannot_be_written_as_utf8_never_gets_this_far(shapes):
    """A recorder of intentions must not fail on what the estimator accepted."""
    try:
        seen = igrip.Observation(**message(0.0, {"\ud800": hand((0, 0, 0))}))
    except igrip.ObservationError:
        return
    for intention in igrip.Estimator(shapes).update(seen):
        assert Intention.from_json(intention.to_json()) == intention
