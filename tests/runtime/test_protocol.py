"""Decoding of messages, whatever they are."""

from __future__ import annotations

import contextlib
import json
from unittest import mock

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from igrip.errors import ObservationError
from igrip.estimator import Estimator
from igrip.observation import Observation
from igrip.runtime.protocol import MAX_SIZE, Command, decode

MESSAGE = {"t": 1.5, "hands": {"right": {"position": [0.1, 0.2, 0.3]}}}


def test_json_as_text_and_bytes_and_messagepack_are_the_same():
    packed = msgspec.msgpack.encode(MESSAGE)
    text = json.dumps(MESSAGE)
    assert decode(packed) == decode(text) == decode(text.encode()) == Observation(**MESSAGE)


@pytest.mark.parametrize(
    ("action", "method"),
    [("veto", "veto"), ("confirm", "confirm"), ("opened", "notify_released")],
)
def test_commands_and_the_methods_that_they_call(action, method):
    command = decode(json.dumps({"control": action, "hand": "left"}))
    assert command == Command(action, "left")
    estimator = mock.create_autospec(Estimator, instance=True)
    assert command.apply(estimator) is getattr(estimator, method).return_value
    assert estimator.mock_calls == [getattr(mock.call, method)("left")]


@pytest.mark.parametrize(
    ("data", "field"),
    [
        ('{"control": "close", "hand": "left"}', "control"),
        ('{"control": "veto", "hand": 7}', "hand"),
        ('{"t": NaN}', "t"),
        ("[" * 100_000, "message"),
        (b"\x91" * 100_000, "message"),
        ('{"t":1,"x":' * 20_000, "message"),
        (b"\xff\xfe", "message"),
        ("", "message"),
        ("null", "message"),
        (" " * (MAX_SIZE + 1), "message"),
    ],
)
def test_malformed_messages_name_the_field(data, field):
    with pytest.raises(ObservationError) as caught:
        decode(data)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("message", "path", "kept"),
    [
        ({"hands": {f"h{k}": None for k in range(33)}}, "hands.h32", 32),
        ({"objects": {f"o{k}": None for k in range(513)}}, "objects.o512", 512),
        ({"objects": {"x" * 129: None, "mug": None}}, "objects", 1),
        ({"hands": {"right": {"position": [0, 0]}, "left": None}}, "hands.right", 2),
    ],
)
def test_what_is_wrong_with_an_entity_costs_that_entity(message, path, kept):
    defects = []
    observation = decode(json.dumps({"t": 1} | message), defects=defects)
    assert [defect.path for defect in defects] == [path]
    assert len(observation.hands) + len(observation.objects) == kept


def test_a_veto_that_names_no_hand_is_for_all():
    assert decode('{"control": "veto"}') == Command("veto", None)


@given(st.one_of(st.binary(max_size=200), st.text(max_size=200)))
def test_nothing_else_is_ever_raised(data):
    with contextlib.suppress(ObservationError):
        assert isinstance(decode(data), Observation | Command)


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=8) | st.integers(-(2**63), 2**63),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(
    st.fixed_dictionaries(
        {}, optional=dict.fromkeys(("t", "hands", "objects", "control", "hand", "schema"), JSON)
    )
)
def test_nor_by_messages_of_odd_parts(raw):
    for data in (json.dumps(raw), msgspec.msgpack.encode(raw)):
        with contextlib.suppress(ObservationError):
            assert isinstance(decode(data), Observation | Command)
