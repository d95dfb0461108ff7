"""Messages entity by entity: what is kept, what is not seen, and what refuses all of it."""

from __future__ import annotations

import copy
import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from igrip import Observation, ObservationError
from igrip.io.frames import DeclaredFrame
from igrip.io.message_reader import MessageReader, decode_json
from malformed import MALFORMED

RIGHT = {"position": [0.1, 0.3, 0.05]}
MUG = {"model": "mug", "position": [0.2, 0.5, 0.1], "orientation": [0.0, 0.0, 0.0, 1.0]}
WHOLE = {"t": 1.0, "hands": {"right": RIGHT}, "objects": {"mug": MUG}}
NONE = [float("nan")] * 3


def read(message, reader=None):
    return (reader or MessageReader()).read(message)


def with_entity(part, id, **changes):
    message = copy.deepcopy(WHOLE)
    message[part].setdefault(id, {}).update(changes)
    return message


def test_a_good_message_is_the_observation_that_its_constructor_makes():
    observation, defects = read(WHOLE)
    assert observation == Observation(**WHOLE)
    assert defects == []


@pytest.mark.parametrize("bad", [
    {"position": NONE}, {"position": None}, {"position": [None] * 3}, {"position": "none"}, {},
    {"position": [1.0, 2.0]}, {"position": [1e999, 0, 0]}, 7, [], "lost", True,
    {"position": [0.1, 0.2, 0.3], "t": "x"}, {"position": [-9999.0] * 3},
    {"position": [99999.99, 0.0, 0.1]},
])  # fmt: skip
def test_a_bad_hand_is_not_seen_and_the_rest_is_taken(bad):
    message = copy.deepcopy(WHOLE)
    message["hands"]["left"] = bad
    observation, defects = read(message)
    assert dict(observation.hands) == {**Observation(**WHOLE).hands, "left": None}
    assert observation.objects == Observation(**WHOLE).objects
    assert [(d.kind, d.path) for d in defects] == [("not seen", "hands.left")]
    assert observation.not_seen == {"hands.left": defects[0].problem}


@pytest.mark.parametrize("orientation", [
    [0.0] * 4, None, [float("nan")] * 4, [None] * 4, [0.5, 0.5, 0.5], [2.0, 0, 0, 0], "x", {},
])  # fmt: skip
def test_an_object_without_a_rotation_is_not_seen(orientation):
    observation, defects = read(with_entity("objects", "mug", orientation=orientation))
    assert dict(observation.objects) == {"mug": None}
    assert observation.hands == Observation(**WHOLE).hands
    assert [d.kind for d in defects] == ["not seen"]


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: math.hypot(*q) > 0.1))
def test_a_quaternion_of_two_decimals_is_normalised(q):
    q = np.array(q) / np.linalg.norm(q)
    rounded = [round(x, 2) for x in q.tolist()]
    observation, defects = read(with_entity("objects", "mug", orientation=rounded))
    taken = np.array(observation.objects["mug"].orientation)
    assert abs(np.linalg.norm(taken) - 1.0) < 5e-3 + 1e-12
    assert np.abs(taken - q).max() < 0.02
    assert {d.kind for d in defects} <= {"corrected"}
    assert bool(defects) == (abs(math.hypot(*rounded) - 1.0) > 5e-3)


@pytest.mark.parametrize(("field", "value"), [
    ("score", float("nan")), ("score", "high"), ("std", -1.0), ("std", NONE), ("source", 3),
    ("landmarks", [[0.1, 0.2, float("nan")]]), ("landmarks", 3), ("orientation", [0.0] * 4),
])  # fmt: skip
def test_a_bad_field_that_is_not_needed_is_left_out(field, value):
    observation, defects = read(with_entity("hands", "right", **{field: value}))
    assert observation == Observation(**WHOLE)
    assert [(d.kind, d.path) for d in defects] == [("left out", f"hands.right.{field}")]


@pytest.mark.parametrize("message", [
    {}, {"t": None}, {"t": float("nan")}, {"t": "1"}, {"t": True}, [], 3, None, "t",
    {"t": 1.0, "schema": "igrip/2"}, {"t": 1.0, "schema": None},
])  # fmt: skip
def test_only_a_broken_envelope_is_refused(message):
    with pytest.raises(ObservationError):
        read(message)


@pytest.mark.parametrize(("plain", "field"), MALFORMED)
def test_whatever_a_constructor_refuses_costs_itself_alone(plain, field):
    broken = field in ("t", "schema", "message")
    try:
        observation, defects = read(plain)
    except ObservationError:
        assert broken
    else:
        assert defects
        assert observation.t >= 0.0


def test_numbers_that_are_none_as_other_languages_print_them():
    for text in ("nan", "-nan", "NaN", "-nan(ind)", "1.#QNAN", "inf", "-Infinity"):
        line = f'{{"t": 1.0, "hands": {{"left": {{"position": [{text}, 0.1,{text}]}}}}}}'
        observation, _ = read(decode_json(line.encode()))
        assert dict(observation.hands) == {"left": None}


def test_times_below_zero_count_from_the_first():
    reader = MessageReader()
    first, defects = read({"t": -0.5, "hands": {"right": RIGHT | {"t": -0.5}}}, reader)
    assert (first.t, first.hands["right"].t) == (0.0, 0.0)
    assert defects[0].path == "t"
    second, defects = read({"t": -0.25, "hands": {"right": RIGHT | {"t": -0.3}}}, reader)
    assert (second.t, second.hands["right"].t) == pytest.approx((0.25, 0.2))
    assert defects == []
    assert reader.shift == 0.5


def test_one_time_below_zero_costs_itself_and_several_are_a_step():
    reader = MessageReader()
    read({"t": 5.0}, reader)
    for t in (-1.0, -0.9):
        with pytest.raises(ObservationError, match="before all times so far"):
            read({"t": t}, reader)
    assert read({"t": 5.1}, reader)[0].t == 5.1
    for t in (-1.0, -0.9):
        with pytest.raises(ObservationError):
            read({"t": t}, reader)
    assert read({"t": -0.8}, reader)[0].t == 0.0
    assert read({"t": -0.7}, reader)[0].t == pytest.approx(0.1)


def test_zeros_are_a_gap_for_a_hand_that_was_elsewhere():
    reader = MessageReader()
    positions = [[0.0, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.0], [0.3, 0.2, 0.1],
                 [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.3, 0.2, 0.1]]  # fmt: skip
    seen = [
        read({"t": k / 30, "hands": {"right": {"position": p}}}, reader)[0].hands["right"]
        for k, p in enumerate(positions)
    ]
    assert [hand is not None for hand in seen] == [True] * 4 + [False] * 2 + [True]


def test_a_declared_frame_is_converted_before_anything_else():
    frame = DeclaredFrame.declare(up="y", length_unit="mm", time_unit="ms", quaternions="wxyz")
    message = {
        "t": 1500.0,
        "hands": {"right": {"position": [100.0, 50.0, -300.0], "t": 1490.0, "std": [1.0, 2.0, 3.0],
                            "landmarks": [[100.0, 50.0, -300.0]]},
                  "left": {"position": [-9999.0, -9999.0, -9999.0]}},
        "objects": {"mug": MUG | {"position": [200.0, 0.0, -500.0], "orientation": [1, 0, 0, 0]}},
    }  # fmt: skip
    observation, defects = read(message, MessageReader(frame))
    right, mug = observation.hands["right"], observation.objects["mug"]
    assert (observation.t, right.t) == pytest.approx((1.5, 1.49))
    assert right.position == pytest.approx((0.1, 0.3, 0.05))
    assert right.landmarks[0] == pytest.approx((0.1, 0.3, 0.05))
    assert right.std == pytest.approx((0.001, 0.003, 0.002))
    assert mug.position == pytest.approx((0.2, 0.5, 0.0))
    assert mug.orientation == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    assert [d.path for d in defects] == ["hands.left"]


def problem_of(message, reader=None):
    """Return why a message or line is refused; None if it is not. Anything else is raised."""
    try:
        read(decode_json(message) if isinstance(message, bytes) else message, reader)
    except ObservationError as error:
        return str(error)
    return None


ODD = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers(-(2**70), 2**70) | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
        st.sampled_from(["t", "hands", "objects", "right", "position", "orientation", "model",
                         "score", "std", "landmarks", "self", "none", "static", "schema"]),
        inner, max_size=4),
    max_leaves=12,
)  # fmt: skip


@settings(max_examples=300)
@given(ODD, ODD, ODD)
def test_nothing_but_observations_and_their_errors(hand, pose, other):
    message = {
        "t": 1.0,
        "hands": {"right": hand, "left": RIGHT},
        "objects": {"mug": pose},
        "x": other,
    }
    observation, _ = read(message)
    assert observation.hands["left"] == Observation(**WHOLE).hands["right"]
    for whole in (other, {"t": 0.5, "hands": other}):
        assert problem_of(whole) is None or len(problem_of(whole)) < 500


def mutants(count):
    """Lines of good messages with bytes changed, removed, doubled or moved."""
    random = np.random.default_rng(0)
    line = json.dumps(WHOLE | {"schema": "igrip/1"}).encode()
    for _ in range(count):
        data = bytearray(line)
        for _ in range(int(random.integers(1, 4))):
            at, kind = int(random.integers(len(data))), int(random.integers(4))
            if kind == 0:
                data[at] = int(random.integers(256))
            elif kind == 1:
                del data[at : at + int(random.integers(1, 6))]
            elif kind == 2:
                data[at:at] = data[at : at + int(random.integers(1, 20))]
            else:
                data[at:at] = random.choice([b"NaN", b"null", b"[", b"}", b"-", b"1e999", b"\xff"])
            data = data or bytearray(b" ")
        yield bytes(data)


@pytest.mark.parametrize("count", [10_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_mutated_lines_give_a_message_or_its_error(count):
    reader, taken = MessageReader(), 0
    for line in mutants(count):
        problem = problem_of(line, reader)
        assert problem is None or len(problem) < 500
        taken += problem is None
    assert count // 20 < taken < count
