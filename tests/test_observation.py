"""Messages: what is accepted, what is blamed on which field, and the way to JSON and back."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import json
import pickle

import msgspec
import numpy as np
import pytest

from igrip import Hand, IgripError, ObjectPose, Observation, ObservationError
from malformed import HAND, MALFORMED, MUG, P
from support import UPRIGHT, hand, message, plain_json, pose

IDS = [f"{k}-{field}" for k, (_, field) in enumerate(MALFORMED)]

FULL = {
    "schema": "igrip/1",
    "t": 12.345,
    "hands": {
        "right": {
            "position": [0.1, 0.3, 0.05],
            "t": 12.3,
            "orientation": [0.0, 0.6, 0.0, 0.8],
            "landmarks": [[0.1, 0.3, 0.05], [0.2, 0.3, 0.05]],
            "std": [0.001, 0.002, 0.003],
            "score": 0.9,
            "source": "camera 1",
        },
        "left": None,
    },
    "objects": {
        "mustard": {
            "position": [0.2, 0.5, 0.1],
            "orientation": [0.0, 0.0, 0.0, 1.0],
            "model": "006_mustard_bottle",
            "t": 12.1,
            "static": True,
            "std": 0.002,
            "score": -3.5,
            "source": "tags",
        },
        "soup": None,
    },
}


@pytest.mark.parametrize(("plain", "field"), MALFORMED, ids=IDS)
def test_malformed(plain, field):
    with pytest.raises(ObservationError) as raised:
        Observation(**plain)
    assert raised.value.field == field
    assert str(raised.value).startswith(f"{field}: ")
    assert raised.value.problem
    with pytest.raises(ObservationError) as raised:
        Observation.from_dict(plain)
    assert raised.value.field == field


@pytest.mark.parametrize(("plain", "field"), MALFORMED, ids=IDS)
@pytest.mark.parametrize("text", [str, str.encode], ids=["str", "bytes"])
def test_malformed_json(plain, field, text):
    line = json.dumps(plain)  # NaN and Infinity as Python writes them
    with pytest.raises(ObservationError) as raised:
        Observation.from_json(text(line))
    assert raised.value.field == field


@pytest.mark.parametrize(
    ("line", "field"),
    [
        (b'{"t":1.0,"hands":{"right":{"position":[1e999,0,0]}}}', f"{HAND}.position[0]"),
        (b'{"t":1e999}', "t"),
        (b'{"t":-1e999}', "t"),
        (b"", "message"),
        (b"   ", "message"),
        (b"not json", "message"),
        (b'{"t":1.0', "message"),
        (b'{"t":1.0}}', "message"),
        (b'{"t":1.0} {"t":2.0}', "message"),
        (b"[]", "message"),
        (b"null", "message"),
        (b"3", "message"),
        (b'"t"', "message"),
        (b"\xff\xfe\x00", "message"),
        (b'{"t":1.0,"hands":{"\xff":null}}', "message"),
        (b'{"t":' + b"[" * 5000 + b"]" * 5000 + b"}", "message"),
        (b'{"t":' + b"1" * 5000 + b"}", "t"),
    ],
    ids=range(17),
)
def test_text_that_is_no_message(line, field):
    with pytest.raises(ObservationError) as raised:
        Observation.from_json(line)
    assert raised.value.field in (field, "message")
    assert len(str(raised.value)) < 500


@pytest.mark.parametrize("place", ['"schema":%s', '"t":%s', '"hands":%s', '"x":%s',
                                   '"hands":{"r":%s}', '"hands":{"r":{"position":%s}}',
                                   '"hands":{"r":{"position":[0,0,0],"landmarks":%s}}',
                                   '"objects":{"r":{"model":%s}}'])  # fmt: skip
def test_nesting_to_any_depth(place):
    for depth in (*range(1, 40), *range(900, 1010), 3000):
        line = '{"t":1.0,' + place % ("[" * depth + "]" * depth) + "}"
        if place.startswith('"x"') and depth < 900:
            assert Observation.from_json(line).unknown_fields == 1
            continue
        with contextlib.suppress(ObservationError):  # and nothing else
            Observation.from_json(line)


def test_errors_name_python_types_that_json_has_not():
    for position in ({0.1, 0.2, 0.3}, b"123", range(3), object(), iter(P), 1j):
        with pytest.raises(ObservationError) as raised:
            Observation(t=0.0, hands={"right": {"position": position}})
        assert raised.value.field == f"{HAND}.position"


@pytest.mark.parametrize(
    ("plain", "field"),
    [
        ({"t": 0.0, "hands": {3: None}}, "hands"),
        ({"t": 0.0, "objects": {("a", "b"): None}}, "objects"),
        ({3: 0.0}, "message"),
        ([], "message"),
        (None, "message"),
    ],
)
def test_keys_that_json_has_not(plain, field):
    with pytest.raises(ObservationError) as raised:
        Observation.from_dict(plain)
    assert raised.value.field.startswith(field)


def test_an_array_in_place_of_the_schema_is_malformed_too():
    with pytest.raises(ObservationError) as raised:
        Observation(t=0.0, schema=np.array(["igrip/1", "igrip/1"]))
    assert raised.value.field == "schema"


def test_long_ids_and_values_are_cut_in_errors():
    plain = {"t": 1.0, "objects": {"x" * 10_000: {"position": P, "orientation": [0, 0, 0, 5]}}}
    with pytest.raises(ObservationError) as raised:
        Observation(**plain)
    assert len(str(raised.value)) < 300
    with pytest.raises(ObservationError) as raised:
        Observation(t=1.0, schema="x" * 10_000)
    assert len(str(raised.value)) < 300


def test_an_error_survives_pickling():
    with pytest.raises(ObservationError) as raised:
        Observation(t=-1.0)
    again = pickle.loads(pickle.dumps(raised.value))
    assert (again.field, again.problem) == (raised.value.field, raised.value.problem)
    assert str(again) == str(raised.value)
    assert isinstance(again, IgripError)
    assert isinstance(again, ValueError)


# what is accepted --------------------------------------------------------------------------------


def test_every_field():
    seen = Observation(**FULL)
    right, mustard = seen.hands["right"], seen.objects["mustard"]
    assert seen.t == 12.345
    assert right.position == (0.1, 0.3, 0.05)
    assert right.orientation == (0.0, 0.6, 0.0, 0.8)
    assert right.landmarks == ((0.1, 0.3, 0.05), (0.2, 0.3, 0.05))
    assert (right.t, right.std, right.score) == (12.3, (0.001, 0.002, 0.003), 0.9)
    assert right.source == "camera 1"
    assert seen.hands["left"] is None
    assert (mustard.model, mustard.static, mustard.std) == ("006_mustard_bottle", True, 0.002)
    assert seen.objects["soup"] is None
    assert seen.unknown_fields == 0
    assert not seen.is_tick


@pytest.mark.parametrize("text", [str, str.encode], ids=["str", "bytes"])
def test_json_and_back(text):
    seen = Observation.from_json(text(json.dumps(FULL)))
    assert seen == Observation(**FULL)
    assert json.loads(seen.to_json()) == FULL
    assert plain_json(seen.to_dict()) == FULL
    assert Observation.from_json(seen.to_json()) == seen
    assert b"\n" not in seen.to_json()


def test_the_schema_may_be_left_out_and_is_written():
    assert json.loads(Observation(t=1.0).to_json()) == {"schema": "igrip/1", "t": 1.0}


def test_numbers_survive_json_to_the_last_bit():
    rng = np.random.default_rng(0)
    for _ in range(200):
        t, *p = 10.0 ** rng.uniform(-300, 1, 4)
        seen = Observation(**message(t, {"h": hand(p)}))
        again = Observation.from_json(seen.to_json())
        assert (again.t, again.hands["h"].position) == (t, tuple(p))


def test_tick():
    assert Observation(t=0).is_tick
    assert Observation(t=0.0, hands={}, objects={}) == Observation(t=0.0)
    assert not Observation(t=0.0, hands={"left": None}).is_tick


def test_unknown_fields_are_left_out_and_counted():
    plain = message(1.0, {"h": hand(P, colour="red", size=3)}, {"o": pose(P, shape=None)})
    seen = Observation(**plain, session="x", seq=4)
    assert seen.unknown_fields == 5
    assert "colour" not in json.dumps(seen.to_dict())
    assert seen == Observation(**message(1.0, {"h": hand(P)}, {"o": pose(P)}))


def test_numpy_values_are_numbers():
    plain = {
        "t": np.float64(1.5),
        "hands": {"h": {"position": np.array(P), "t": np.float32(1.0), "std": np.array(P),
                        "landmarks": np.array([P, P]), "score": np.float64(0.5)}},
        "objects": {"o": {"position": np.array([1, 2, 3]), "orientation": np.array(UPRIGHT),
                          "std": np.float32(0.5)}},
    }  # fmt: skip
    seen = Observation(**plain)
    assert seen.hands["h"].position == tuple(P)
    assert seen.hands["h"].landmarks == (tuple(P), tuple(P))
    assert seen.hands["h"].std == tuple(P)
    assert type(seen.objects["o"].position[0]) is float
    assert Observation.from_json(seen.to_json()) == seen


@pytest.mark.parametrize("std", [0.5, 1, np.float32(0.5), np.float64(0.5), P, np.array(P)], ids=str)
def test_std_of_any_kind_of_number(std):
    direct = Hand(position=P, std=std)
    through = Observation(t=0.0, hands={"h": {"position": P, "std": std}})
    assert through.hands["h"] == direct
    assert np.allclose(direct.std, std)


def test_entities_may_be_given_as_such():
    right, mug = Hand(position=(0, 0, 1)), ObjectPose(position=P, orientation=UPRIGHT, model="mug")
    seen = Observation(t=0.0, hands={"h": right}, objects={"o": mug})
    assert seen.hands["h"] is right
    assert seen.objects["o"] is mug
    assert right.position == (0.0, 0.0, 1.0)
    assert all(type(x) is float for x in right.position)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Hand(position=(0, 0)), "position"),
        (lambda: Hand(position=(0, 0, "1")), "position[2]"),
        (lambda: Hand(position=P, t=-1), "t"),
        (lambda: Hand(position=P, landmarks=[P, [0]]), "landmarks[1]"),
        (lambda: ObjectPose(position=P, orientation=(0, 0, 0, 0.99)), "orientation"),
        (lambda: ObjectPose(position=P, orientation=UPRIGHT, static=1), "static"),
        (lambda: ObjectPose(position=P, orientation=UPRIGHT, model=1), "model"),
        (lambda: ObjectPose(position=P, orientation=UPRIGHT, source=1), "source"),
    ],
)
def test_entities_check_themselves(make, field):
    with pytest.raises(ObservationError) as raised:
        make()
    assert raised.value.field == field


@pytest.mark.parametrize("norm", [0.9951, 1.0049])
def test_rotations_with_rounded_digits_are_rotations(norm):
    seen = ObjectPose(position=P, orientation=[0.0, 0.6 * norm, 0.0, 0.8 * norm])
    assert seen.orientation == pytest.approx((0.0, 0.6 * norm, 0.0, 0.8 * norm))


def test_it_is_immutable():
    source = copy.deepcopy(FULL)
    seen = Observation(**source)
    source["hands"]["right"]["position"][0] = 99.0
    source["hands"]["other"] = None
    assert seen == Observation(**FULL)
    with pytest.raises(dataclasses.FrozenInstanceError):
        seen.t = 3.0
    with pytest.raises(TypeError):
        seen.hands["x"] = None
    with pytest.raises(AttributeError):
        seen.hands["right"].position = (0, 0, 0)


def test_pickle_and_equality():
    seen = Observation(**FULL)
    assert pickle.loads(pickle.dumps(seen)) == seen
    assert seen != Observation(**{**FULL, "t": 12.346})
    assert hash(seen) == hash(Observation(**copy.deepcopy(FULL)))


def test_equal_messages_have_equal_hashes():
    a = Observation(t=0.0, hands={"left": None, "right": None})
    b = Observation(t=0.0, hands={"right": None, "left": None})
    assert a == b
    assert hash(a) == hash(b)


def test_ids_and_texts_that_cannot_be_written_as_utf8():
    """JSON may escape half a surrogate pair: either refused, or it can be written again."""
    lines = [
        b'{"t":0,"hands":{"\\ud800":{"position":[0,0,0]}}}',
        b'{"t":0,"hands":{"h":{"position":[0,0,0],"source":"\\udfff"}}}',
        b'{"t":0,"objects":{"o":{"position":[0,0,0],"orientation":[0,0,0,1],"model":"\\ud800"}}}',
    ]
    for line in lines:
        try:
            seen = Observation.from_json(line)
        except ObservationError:
            continue
        assert Observation.from_json(seen.to_json()) == seen


def test_other_scripts_in_ids():
    plain = message(
        0.0, {"右手": hand(P)}, {"Flasche ß \N{PILE OF POO}": pose(P, source="κ\n\t\0")}
    )
    seen = Observation(**plain)
    assert Observation.from_json(seen.to_json()) == seen


def test_the_published_schema_describes_what_is_written():
    schema = Observation.json_schema()
    text = json.dumps(schema)
    for name in ("hands", "objects", "position", "orientation", "landmarks", "static", "model"):
        assert name in text
    decoded = msgspec.json.decode(Observation(**FULL).to_json())
    top = schema["$defs"]["Message"]
    assert set(decoded) <= set(top["properties"])
    assert top["required"] == ["t"]
    for name, kind in (("hands", "Hand"), ("objects", "ObjectPose")):
        properties = schema["$defs"][kind]["properties"]
        for entity in filter(None, decoded[name].values()):
            assert set(entity) <= set(properties)
    assert set(schema["$defs"]["ObjectPose"]["required"]) == {"position", "orientation"}


def test_where_two_fields_are_missing_the_first_is_named():
    """In every process: not by the order of a set of strings."""
    with pytest.raises(ObservationError) as raised:
        Observation(t=1.0, objects={"mug": {}})
    assert raised.value.field == f"{MUG}.position"
