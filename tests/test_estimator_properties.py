"""What must not change a result: frame, order, names, clock, and how messages are cut."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import igrip
from igrip.io.recordings.jsonl import JsonlReader, JsonlWriter
from support import close, lines, random_turn, run, scene_of_shapes

SEEDS = st.integers(0, 10_000)
NAMES = ("paper", "repaired", "impacts", "future_distance")
ANSWERS = ("hand", "status", "target", "target_model", "grip", "confidence", "scores")


def answers(intentions):
    """Return what must not change, by hand, in the order of time."""
    by_hand = {}
    for intention in intentions:
        plain = intention.to_dict()
        by_hand.setdefault(intention.hand, []).append({key: plain[key] for key in ANSWERS})
    return by_hand


def some_scene(seed, hands=("left", "right")):
    rng = np.random.default_rng(seed)
    return rng, scene_of_shapes(rng, hands=hands, moving=bool(seed % 2))


def config_of(seed):
    distance = ("vertex", "surface")[seed // 4 % 2]
    return igrip.Config(targets=NAMES[seed % 4], cues={"distance": distance})


def moved(messages, turn, shift):
    """Return messages as they are in another frame of the world."""
    result = json.loads(json.dumps(messages))
    for message in result:
        for hand in message.get("hands", {}).values():
            hand["position"] = (turn.apply(hand["position"]) + shift).tolist()
        for pose in message.get("objects", {}).values():
            pose["position"] = (turn.apply(pose["position"]) + shift).tolist()
            pose["orientation"] = (turn * Rotation.from_quat(pose["orientation"])).as_quat()
            pose["orientation"] = pose["orientation"].tolist()
    return result


@given(SEEDS)
def test_a_rigid_motion_of_the_world(shapes, seed):
    rng, messages = some_scene(seed)
    turn, shift = random_turn(rng), rng.uniform(-2.0, 2.0, 3)
    here = run(messages, shapes, config_of(seed))
    there = run(moved(messages, turn, shift), shapes, config_of(seed))
    assert close(answers(here), answers(there), 1e-6)
    for a, b in zip(here, there, strict=True):
        if a.contact is not None:
            assert a.time_to_contact == pytest.approx(b.time_to_contact, abs=1e-6)
            assert turn.apply(a.contact) + shift == pytest.approx(np.array(b.contact), abs=1e-5)


@given(SEEDS)
def test_order_of_objects_and_hands_in_a_message(shapes, seed):
    rng, messages = some_scene(seed)
    mixed = []
    for message in messages:
        other = dict(message)
        for kind in ("hands", "objects"):
            if kind in message:
                items = list(message[kind].items())
                other[kind] = dict(items[k] for k in rng.permutation(len(items)))
        mixed.append(other)
    config = config_of(seed)
    assert answers(run(messages, shapes, config)) == answers(run(mixed, shapes, config))


def renamed(messages, kind, names):
    return [
        {**message, kind: {names[id]: entry for id, entry in message[kind].items()}}
        if kind in message else message
        for message in messages
    ]  # fmt: skip


@given(SEEDS, st.permutations(["a", "zz", "右", "", "left", "none of these"]))
def test_names_of_objects(shapes, seed, names):
    _, messages = some_scene(seed)
    naming = dict(zip(("box", "can", "tin"), names, strict=False))
    config = config_of(seed)
    plain = answers(run(messages, shapes, config))
    other = answers(run(renamed(messages, "objects", naming), shapes, config))
    for hand, rows in plain.items():
        for a, b in zip(rows, other[hand], strict=True):
            a["scores"] = {naming[id]: scores for id, scores in a["scores"].items()}
            a["target"] = a["target"] and naming[a["target"]]
            assert a == b


@given(SEEDS, st.permutations(["a", "zz", "右", "", "none", "box"]))
def test_names_of_hands(shapes, seed, names):
    _, messages = some_scene(seed, hands=("left", "right", "third"))
    naming = dict(zip(("left", "right", "third"), names, strict=False))
    config = config_of(seed)
    plain = answers(run(messages, shapes, config))
    other = answers(run(renamed(messages, "hands", naming), shapes, config))
    assert {naming[hand] for hand in plain} == set(other)
    for hand, rows in plain.items():
        assert [{**row, "hand": naming[hand]} for row in rows] == other[naming[hand]]


@given(SEEDS, st.sampled_from([1000.0, 0.123, 1.7e9]))
def test_another_zero_of_the_clock(shapes, seed, offset):
    _, messages = some_scene(seed)
    later = json.loads(json.dumps(messages))
    for message in later:
        message["t"] += offset
        for kind in ("hands", "objects"):
            for entry in message.get(kind, {}).values():
                entry["t"] += offset
    config = config_of(seed)
    here, there = run(messages, shapes, config), run(later, shapes, config)
    if offset < 1e6:  # at 1.7e9 s a double resolves 0.2 µs: a ray may fall to the other side
        assert close(answers(here), answers(there), 1e-6)
    assert [i.status for i in here] == [i.status for i in there]
    same = sum(a.target == b.target for a, b in zip(here, there, strict=True))
    assert same >= 0.95 * len(here)


def split(messages, parts):
    """Return messages cut into several of the same time; parts gives the pieces of one."""
    return [
        {"t": message["t"], **piece} for message in messages for piece in parts(message) if piece
    ]


@given(SEEDS)
def test_objects_and_then_hands_in_two_messages(shapes, seed):
    _, messages = some_scene(seed)
    pieces = split(
        messages,
        lambda m: [{k: m[k]} for k in ("objects", "hands") if k in m],
    )
    config = config_of(seed)
    assert answers(run(messages, shapes, config)) == answers(run(pieces, shapes, config))


@given(SEEDS, st.booleans())
def test_two_hands_in_two_messages(shapes, seed, backwards):
    _, messages = some_scene(seed)

    def parts(message):
        hands = sorted(message.get("hands", {}).items(), reverse=backwards)
        rest = [{"objects": message["objects"]}] if "objects" in message else []
        return [*rest, *({"hands": {id: hand}} for id, hand in hands)]

    config = config_of(seed)
    whole = answers(run(messages, shapes, config))
    assert whole == answers(run(split(messages, parts), shapes, config))


@given(SEEDS)
def test_ticks_between_messages(shapes, seed):
    _, messages = some_scene(seed)
    ticked = [
        piece
        for message in messages
        for piece in ({"t": message["t"]}, message, {"t": message["t"]})
    ]
    config = config_of(seed)
    assert lines(run(messages, shapes, config)) == lines(run(ticked, shapes, config))


@given(SEEDS)
def test_a_hand_does_not_depend_on_the_others(shapes, seed):
    _, messages = some_scene(seed, hands=("left", "right", "third"))
    together = answers(run(messages, shapes, config_of(seed)))
    for id in together:
        alone = [
            {**message, "hands": {id: message["hands"][id]}} if "hands" in message else message
            for message in messages
        ]
        assert answers(run(alone, shapes, config_of(seed)))[id] == together[id]


@given(SEEDS)
def test_the_future_does_not_change_the_past(shapes, seed):
    _, messages = some_scene(seed)
    whole = lines(run(messages, shapes, config_of(seed)))
    cut = len(messages) * 2 // 3
    part = lines(run(messages[:cut], shapes, config_of(seed)))
    assert whole[: len(part)] == part


@pytest.mark.parametrize("seed", range(4))
def test_replays_are_the_same_to_the_last_bit(shapes, tmp_path, seed):
    _, messages = some_scene(seed)
    config = config_of(seed)
    first = run(messages, shapes, config)
    assert lines(run(messages, shapes, config)) == lines(first)
    with JsonlWriter(tmp_path / "scene.jsonl") as writer:
        for message in messages:
            writer.write(igrip.Observation(**message))
    estimator = igrip.Estimator(shapes, config)
    again = [i for o in JsonlReader(tmp_path / "scene.jsonl") for i in estimator.update(o)]
    assert lines(again) == lines(first)
    assert len(first) > 20


@given(SEEDS)
def test_scores_stay_in_their_ranges(shapes, seed):
    rng = np.random.default_rng(seed)
    messages = scene_of_shapes(rng)
    for message in messages:  # at rest, so that the derivative is at most the speed of the hand
        for pose in message.get("objects", {}).values():
            pose["static"] = True
    answered = 0
    for name in ("paper", "repaired"):
        for intention in run(messages, shapes, igrip.Config(targets=name)):
            total = 0.0
            for scores in intention.scores.values():
                answered += 1
                for metric in ("impacts", "distance", "future_distance"):
                    assert 0.0 <= scores[metric] <= 1.0
                assert -1.0 - 1e-12 <= scores["distance_derivative"] <= 1.0 + 1e-12
                assert min(scores.values()) - 1e-12 <= scores["global"]
                assert scores["global"] <= max(scores.values()) + 1e-12
                total += scores["impacts"]
            assert total == pytest.approx(1.0) or total == 0.0
            if intention.target is not None:
                best = max(intention.scores, key=lambda id: intention.scores[id]["global"])
                assert intention.target == best
                assert intention.confidence == intention.scores[best]["global"] > 0.0
                assert intention.grip in ("palmar", "pinch")
            else:
                assert (intention.grip, intention.confidence) == (None, None)
    assert answered > 50


@given(SEEDS)
def test_the_sign_of_quaternions(shapes, seed):
    rng, messages = some_scene(seed)
    flipped = json.loads(json.dumps(messages))
    for message in flipped:
        for pose in message.get("objects", {}).values():
            sign = rng.choice([-1.0, 1.0])
            pose["orientation"] = [sign * x for x in pose["orientation"]]
    config = config_of(seed)
    assert close(answers(run(messages, shapes, config)), answers(run(flipped, shapes, config)))
