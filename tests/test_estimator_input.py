"""Odd but well-formed input: the status and reason of one hand or object, never an exception."""

from __future__ import annotations

import json
import math

import msgspec
import numpy as np
import pytest

import igrip
from igrip import Config, Estimator, Observation
from igrip.errors import UnknownNameError
from support import BOX, CAN, feed, hand, lines, message, pose, run, scene_of_shapes

BODY = {"box": pose((0.3, 0.0, 0.0), model=BOX)}


def path(k):
    """A hand on its way to the box, with some noise so that it is not frozen."""
    return (0.004 * k + 1e-5 * math.sin(k), 0.01, 0.0)


def stream(start, count, first=0, objects=True, hands=("right",), **own):
    """Return messages at 30 Hz."""
    return [
        message(
            start + k / 30, {id: hand(path(first + k), **own) for id in hands},
            BODY if objects else None,
        )
        for k in range(count)
    ]  # fmt: skip


def only(intentions):
    [intention] = intentions if isinstance(intentions, list) else intentions.values()
    return intention


# hands -------------------------------------------------------------------------------------------


def test_warming_up_says_what_is_missing(shapes):
    first, second, third = run(stream(1.0, 3), shapes)
    assert (first.status, second.status) == ("warming_up", "warming_up")
    assert first.reason.startswith("1 ")
    assert second.reason.startswith("2 ")
    assert first.target is None
    assert first.scores == {}
    assert third.status in ("idle", "reaching")
    assert set(third.scores) == {"box"}


def test_a_jump_of_a_metre_and_back(shapes):
    estimator = Estimator(shapes)
    before = only(feed(estimator, *stream(1.0, 20)))
    assert before.target == "box"
    jumped = only(feed(estimator, message(1.0 + 20 / 30, {"right": hand((1.1, 0.0, 0.0))})))
    assert jumped.status == "invalid"
    assert "jumped" in jumped.reason
    assert (jumped.target, jumped.grip, jumped.scores) == (None, None, {})
    after = only(feed(estimator, *stream(1.0 + 21 / 30, 1, first=21)))
    assert after.status == before.status
    assert after.target == "box"
    assert after.reason is None
    assert estimator.inputs()["hands"]["right"]["counts"] == {"jump": 1}


@pytest.mark.parametrize("distance", [1.0, 2.0])
def test_a_jump_that_stays(shapes, distance):
    """0.3 s invalid, then a new beginning; never a movement of metres per second."""
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 20))
    seen = []
    for k in range(20, 40):
        x, y, z = path(k)
        plain = message(1.0 + k / 30, {"right": hand((x + distance, y, z))}, BODY)
        seen.append(only(feed(estimator, plain)))
        speed = estimator.hands["right"].motion and estimator.hands["right"].motion.speed
        assert speed is None or speed < 0.5
    statuses = [intention.status for intention in seen]
    first = statuses.index("warming_up")
    assert statuses[:first] == ["invalid"] * first
    assert 8 <= first <= 10
    assert statuses[first : first + 2] == ["warming_up"] * 2
    assert set(statuses[first + 2 :]) <= {"idle", "reaching"}
    assert estimator.inputs()["hands"]["right"]["counts"]["restarts"] == 1


def test_a_hand_is_lost_once_and_found_again(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 20))
    last = 1.0 + 19 / 30
    heard = []
    for k in range(1, 60):
        heard += estimator.update(Observation(t=last + 0.05 * k))
    lost = only(heard)
    assert (lost.hand, lost.status, lost.target) == ("right", "lost", None)
    assert 0.3 < lost.t - last <= 0.35 + 1e-9
    assert lost.reason.startswith("not measured for")
    found = feed(estimator, *stream(last + 4.0, 1))
    assert only(found).status == "warming_up"
    assert only(feed(estimator, *stream(last + 4.1, 2))).status in ("idle", "reaching")


def test_loss_is_noticed_by_any_message(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10, hands=("left", "right")))
    heard = []
    for k in range(10, 40):
        heard += estimator.update(Observation(**stream(1.0 + k / 30, 1, first=k)[0]))
    lost = [intention for intention in heard if intention.hand == "left"]
    assert [intention.status for intention in lost] == ["lost"]
    assert len(heard) == 31


def test_an_invalid_hand_that_falls_silent_is_lost_too(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10))
    feed(estimator, message(1.0 + 10 / 30, {"right": hand((3.0, 0.0, 0.0))}))
    heard = []
    for k in range(1, 40):
        heard += estimator.update(Observation(t=1.0 + 10 / 30 + 0.05 * k))
    assert [intention.status for intention in heard] == ["lost"]
    assert estimator.inputs()["hands"]["right"]["status"] == "lost"


def test_null_is_no_measurement(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10))
    for k in range(10, 18):
        assert estimator.update(Observation(t=1.0 + k / 30, hands={"right": None})) == []
    heard = []
    for k in range(18, 22):
        heard += estimator.update(Observation(t=1.0 + k / 30, hands={"right": None, "left": None}))
    assert [(i.hand, i.status) for i in heard] == [("right", "lost")]


def test_an_older_measurement_is_ignored_and_counted(shapes):
    plain, twin = Estimator(shapes), Estimator(shapes)
    messages = stream(1.0, 12)
    old = message(1.0 + 11 / 30, {"right": hand((0.0, 0.5, 0.0), t=1.2)})
    feed(plain, *messages)
    feed(twin, *messages)
    assert twin.update(Observation(**old)) == []
    following = stream(1.0 + 12 / 30, 5, first=12)
    assert lines(run(following, shapes, estimator=plain)) == lines(
        run(following, shapes, estimator=twin)
    )
    assert twin.inputs()["hands"]["right"]["counts"] == {"older": 1}


@pytest.mark.parametrize("step", [0.35, 1.0, 60.0])
def test_a_stepped_clock_of_one_hand_heals(shapes, step):
    estimator = Estimator(shapes)
    t = [100.0 + k / 30 for k in range(60)]
    for k in range(10):
        heard = feed(estimator, message(t[k], {"right": hand(path(k), t=t[k])}, BODY))
    assert only(heard).status == "reaching"
    seen = []
    for k in range(10, 40):
        plain = message(t[k], {"right": hand(path(k), t=t[k] - step)}, BODY)
        seen += estimator.update(Observation(**plain))
    statuses = [intention.status for intention in seen]
    assert statuses[0] in ("lost", "warming_up")  # 0.3 s without a measurement, or anew
    while statuses[0] == "lost":
        statuses.pop(0)
    assert statuses[:2] == ["warming_up"] * 2
    assert set(statuses[2:]) <= {"idle", "reaching"}
    assert len(statuses) > 15
    assert seen[-1].target == "box"
    assert "clock" in seen[-1].reason
    counts = estimator.inputs()["hands"]["right"]["counts"]
    assert counts["restarts"] == 1
    assert 8 <= counts["older"] <= 11


def test_a_small_step_of_a_clock_is_only_a_pause(shapes):
    estimator = Estimator(shapes)
    for k in range(20):
        t = 1.0 + k / 30
        own = t if k < 10 else t - 0.15
        told = estimator.update(Observation(**message(t, {"right": hand(path(k), t=own)}, BODY)))
        assert len(told) == (0 if 10 <= k < 14 else 1)
    assert estimator.inputs()["hands"]["right"]["counts"] == {"older": 4}
    assert told[0].status == "reaching"


def test_a_stepped_clock_of_an_object_heals(shapes):
    estimator = Estimator(shapes)
    for k in range(40):
        t = 10.0 + k / 30
        own = t if k < 10 else t - 5.0
        feed(estimator, message(t, None, {"box": pose((0.3 + 0.001 * k, 0, 0), model=BOX, t=own)}))
    report = estimator.inputs()["objects"]["box"]
    assert report["usable"]
    assert report["counts"]["restarts"] == 1
    assert 8 <= report["counts"]["older"] <= 11
    assert estimator.objects[0].translation[0] > 0.33  # it follows again


def test_a_measurement_from_the_future(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10))
    ahead = only(feed(estimator, message(1.4, {"right": hand(path(10), t=1.5)})))
    assert ahead.status == "invalid"
    assert "future" in ahead.reason
    again = only(feed(estimator, message(1.41, {"right": hand(path(10), t=1.44)})))
    assert again.status == "reaching"  # within the tolerance


@pytest.mark.parametrize("value", [1e300, -1e300, 101.0])
def test_positions_beyond_any_room(shapes, value):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10))
    far = only(feed(estimator, message(1.4, {"right": hand((0.0, value, 0.0))})))
    assert far.status == "invalid"
    assert "unit" in far.reason
    assert only(feed(estimator, *stream(1.42, 1, first=12))).status == "reaching"
    objects = {"box": pose((value, 0.0, 0.0), model=BOX)}
    told = only(feed(estimator, message(1.5, {"right": hand(path(14))}, objects)))
    assert told.reason.startswith("box: ")
    assert "unit" in told.reason
    assert told.target == "box"  # where it was last seen, as long as that is fresh
    assert estimator.objects[0].translation == pytest.approx([0.3, 0.0, 0.0])


def test_duplicate_times(shapes):
    """The same message twice: the second time nothing is new."""
    estimator = Estimator(shapes)
    for plain in stream(1.0, 10):
        assert len(estimator.update(Observation(**plain))) == 1
        assert estimator.update(Observation(**plain)) == []
    counts = estimator.inputs()["hands"]["right"]["counts"]
    assert counts == {"older": 10}


@pytest.mark.parametrize("gap", [5e-324, 1e-310, 1e-12, 2.3e-16])
def test_two_samples_at_nearly_the_same_time(shapes, gap):
    """At the beginning of the clock, where such a gap can be told from none."""
    estimator = Estimator(shapes)
    feed(estimator, message(0.0, {"right": hand((0.0, 0.0, 0.0))}, BODY))
    feed(estimator, message(gap, {"right": hand((0.01, 0.0, 0.0))}))
    for k in range(1, 10):
        told = only(feed(estimator, message(k / 30, {"right": hand(path(k))}, BODY)))
        for scores in told.scores.values():
            assert all(math.isfinite(score) for score in scores.values())
    assert told.status in ("idle", "reaching")


def test_a_frozen_hand_is_named(shapes):
    still = [message(1.0 + k / 30, {"right": hand((0.1, 0.0, 0.0))}, BODY) for k in range(30)]
    told = run(still, shapes)
    assert told[10].reason is None
    assert told[-1].reason.startswith("frozen")


@pytest.mark.parametrize(
    "bad",
    [
        lambda k: hand((5.0 * (k % 2), 0.0, 0.0)),
        lambda k: hand((1e200, 0.0, 0.0)),
        lambda k: hand((0.0, 0.0, 0.0), t=99.0),
        lambda k: hand((0.1, 0.1, 0.1), t=0.5),
        lambda k: None,
    ],
    ids=["jumping", "far", "future", "old", "absent"],
)
def test_a_bad_hand_leaves_the_good_one_alone(shapes, bad):
    good = scene_of_shapes(np.random.default_rng(3), hands=("right",))
    alone = lines(run(good, shapes))
    beside = []
    for k, plain in enumerate(good):
        beside.append({**plain, "hands": {"left": bad(k), **plain.get("hands", {})}})
    told = run(beside, shapes)
    assert lines([i for i in told if i.hand == "right"]) == alone


def test_more_hands_than_are_followed(shapes):
    config = Config(tracking={"max_hands": 2})
    three = stream(1.0, 10, hands=("a", "b", "c"))
    estimator = Estimator(shapes, config)
    told = run(three, shapes, estimator=estimator)
    assert {intention.hand for intention in told} == {"a", "b"}
    assert estimator.inputs()["counts"]["too_many"] == 10
    # one of them lost makes room
    later = stream(3.0, 5, hands=("a", "c"))
    assert {i.hand for i in run(later, shapes, estimator=estimator)} == {"a", "c"}


def test_a_hand_that_was_forgotten_begins_anew(shapes):
    config = Config(tracking={"max_hands": 1})
    estimator = Estimator(shapes, config)
    run(stream(1.0, 10, hands=("a",)), shapes, estimator=estimator)
    run(stream(3.0, 10, hands=("b",)), shapes, estimator=estimator)
    again = run(stream(5.0, 4, hands=("a",)), shapes, estimator=estimator)
    assert [i.status for i in again[:3]] == ["warming_up", "warming_up", "idle"]
    fresh = run(stream(5.0, 4, hands=("a",)), shapes, config)
    assert lines(again) == lines(fresh)


def test_time_to_contact_counts_from_the_message(shapes):
    """A measurement that is 0.1 s old leaves 0.1 s less."""
    told = []
    for delay in (0.0, 0.1):
        measured = 2.0 + 24 / 30
        messages = [
            message(2.0 + k / 30 + delay, {"right": hand((0.006 * k, 0, 0), t=2.0 + k / 30)}, BODY)
            for k in range(25)
        ]
        told.append(run(messages, shapes)[-1])
        assert told[-1].t == pytest.approx(measured + delay)
    fresh, old = told
    assert fresh.time_to_contact - old.time_to_contact == pytest.approx(0.1)
    assert fresh.time_to_end - old.time_to_end == pytest.approx(0.1)
    highest = [seen.time_to_contact_interval[1] for seen in told]
    assert highest[0] - highest[1] == pytest.approx(0.1)
    assert fresh.contact == pytest.approx(old.contact)


# objects -----------------------------------------------------------------------------------------


def test_no_object_at_all(shapes):
    told = run(stream(1.0, 10, objects=False), shapes)[-1]
    assert (told.status, told.target, told.grip, told.scores) == ("reaching", None, None, {})
    assert told.reason == "no usable object"


def test_an_unknown_model(shapes):
    estimator = Estimator(shapes)
    odd = {"ghost": pose((0.3, 0.2, 0.0), model="no such model"), **BODY}
    for plain in stream(1.0, 10):
        told = only(feed(estimator, {**plain, "objects": odd}))
    assert told.target == "box"
    assert set(told.scores) == {"box"}
    assert "ghost" in told.reason
    assert "no such model" in told.reason
    assert not estimator.inputs()["objects"]["ghost"]["usable"]


def test_nothing_but_unknown_models(shapes):
    odd = {f"ghost{k}": pose((0.3, 0.2, 0.0), model="no such model") for k in range(5)}
    for plain in stream(1.0, 5):
        told = run([{**plain, "objects": odd}] * 1, shapes)
    estimator = Estimator(shapes)
    for plain in stream(1.0, 5):
        told = only(feed(estimator, {**plain, "objects": odd}))
    assert told.target is None
    assert told.reason.startswith("no usable object")
    assert "and 2 more" in told.reason


@pytest.mark.parametrize("static", [False, True])
def test_an_object_is_usable_for_two_seconds(shapes, static):
    estimator = Estimator(shapes)
    seen = {"box": pose((0.3, 0.0, 0.0), model=BOX, static=static)}
    feed(estimator, message(1.0, None, seen))
    told = {}
    for k in range(80):
        t = 1.0 + k / 30
        told[t] = only(feed(estimator, message(t, {"right": hand(path(k))})))
    for t, intention in told.items():
        if intention.status == "warming_up":
            continue
        usable = static or t - 1.0 <= 2.0
        assert (set(intention.scores) == {"box"}) == usable
        if not usable:
            assert intention.target is None
            assert intention.reason == "no usable object; box: not detected for too long"
    # a new look at it brings it back
    back = only(feed(estimator, message(4.0, {"right": hand(path(81))}, seen)))
    assert back.status == "warming_up"  # this hand had a gap
    assert estimator.inputs()["objects"]["box"]["usable"]


def test_one_object_vanishes_among_others(shapes):
    estimator = Estimator(shapes)
    both = {**BODY, "can": pose((0.0, 0.3, 0.0), model=CAN)}
    feed(estimator, {**stream(1.0, 1)[0], "objects": both})
    for k in range(1, 75):
        told = only(feed(estimator, *stream(1.0 + k / 30, 1, first=k)))
    assert set(told.scores) == {"box"}
    assert told.reason is None  # not being seen is no fault


def test_a_null_object_keeps_its_pose(shapes):
    estimator = Estimator(shapes)
    feed(estimator, *stream(1.0, 10))
    before = estimator.objects[0].translation.copy()
    feed(estimator, message(1.5, None, {"box": None, "never seen": None}))
    assert (estimator.objects[0].translation == before).all()
    assert estimator.inputs()["objects"]["box"]["counts"] == {"missed": 1}
    assert set(estimator.inputs()["objects"]) == {"box"}


def test_an_object_may_be_null_before_it_is_seen(shapes):
    estimator = Estimator(shapes)
    feed(estimator, message(1.0, None, {"box": None}))
    assert estimator.inputs()["objects"] == {}
    feed(estimator, message(1.1, None, BODY))
    assert estimator.inputs()["objects"]["box"]["usable"]


def test_the_model_need_not_be_repeated(shapes):
    estimator = Estimator(shapes)
    feed(estimator, message(1.0, None, BODY))
    feed(estimator, message(1.1, None, {"box": pose((0.31, 0.0, 0.0))}))
    assert estimator.inputs()["objects"]["box"]["model"] == BOX
    assert estimator.objects[0].translation[0] > 0.3


def test_an_object_that_jumps_stays_where_it_was_until_it_stays_elsewhere(shapes):
    estimator = Estimator(shapes)
    where, faults = [], []
    for k in range(40):
        t = 1.0 + k / 12
        x = 0.3 if k < 10 or k == 39 else 3.5
        objects = {"box": pose((x, 0.001 * k, 0.0), model=BOX)}
        told = only(feed(estimator, message(t, {"right": hand(path(k))}, objects)))
        where.append(estimator.objects[0].translation[0])
        faults.append(told.reason is not None and "box: jumped" in told.reason)
        assert estimator.inputs()["objects"]["box"]["usable"]
    moved = next(k for k, x in enumerate(where) if x > 1.0)
    assert moved in (13, 14)  # 0.3 s
    assert where[:moved] == pytest.approx([0.3] * moved)
    assert where[moved:] == pytest.approx([3.5] * (40 - moved))
    assert faults[3:10] == [False] * 7
    assert faults[10:moved] == [True] * (moved - 10)
    assert faults[moved:39] == [False] * (39 - moved)
    assert faults[39]


def test_an_object_that_is_refused_for_long_is_no_longer_used(shapes):
    estimator = Estimator(shapes)
    feed(estimator, message(1.0, None, BODY))
    for k in range(1, 80):
        ahead = {"box": pose((0.3, 0.0, 0.0), model=BOX, t=1e6)}
        told = only(feed(estimator, message(1.0 + k / 30, {"right": hand(path(k))}, ahead)))
    assert told.target is None
    assert told.scores == {}
    assert "future" in told.reason


def test_a_held_pose_keeps_its_age(shapes):
    """A tracker that repeats the last pose with its old time: usable for 2 s, not longer."""
    estimator = Estimator(shapes)
    for k in range(90):
        t = 1.0 + k / 30
        held = {"box": pose((0.3, 0.0, 0.0), model=BOX, t=1.0)}
        told = only(feed(estimator, message(t, {"right": hand(path(k))}, held)))
        if told.status != "warming_up" and abs(t - 3.0) > 1e-6:
            assert (set(told.scores) == {"box"}) == (t < 3.0)


def test_a_moving_object(shapes):
    """The hand rests, the box comes: the derivative is that of the distance between the two."""
    estimator = Estimator(shapes)
    for k in range(30):
        t = 1.0 + k / 30
        objects = {"box": pose((0.6 - 0.3 * k / 30, 0.0, 0.0), model=BOX)}
        where = (0.05 * k / 30, 1e-6 * (k % 2), 0.0)
        told = only(feed(estimator, message(t, {"right": hand(where)}, objects)))
    assert told.scores["box"]["distance_derivative"] > 3.0  # more than the hand's own speed gives
    [body] = estimator.objects
    assert body.velocity == pytest.approx([-0.3, 0.0, 0.0], abs=0.06)


def test_jitter_of_a_resting_object_is_no_velocity(shapes):
    rng = np.random.default_rng(1)
    estimator = Estimator(shapes)
    for k in range(40):
        where = np.array([0.3, 0.0, 0.0]) + rng.normal(0.0, 0.0005, 3)
        feed(estimator, message(1.0 + k / 12, None, {"box": pose(where, model=BOX)}))
        assert estimator.objects[0].velocity.tolist() == [0.0, 0.0, 0.0]


def test_more_objects_than_are_followed(shapes):
    config = Config(tracking={"max_objects": 3})
    estimator = Estimator(shapes, config)
    five = {f"o{k}": pose((0.1 * k, 0.4, 0.0), model=CAN) for k in range(5)}
    told = run([{**plain, "objects": five} for plain in stream(1.0, 5)], shapes,
               estimator=estimator)  # fmt: skip
    assert set(told[-1].scores) == {"o0", "o1", "o2"}
    assert estimator.inputs()["counts"]["too_many"] == 10


def test_a_lost_object_makes_room(shapes):
    estimator = Estimator(shapes, Config(tracking={"max_objects": 1}))
    feed(estimator, message(1.0, None, BODY))
    feed(estimator, message(2.0, None, {"can": pose((0, 0, 0), model=CAN)}))
    assert set(estimator.inputs()["objects"]) == {"box"}
    feed(estimator, message(9.0, None, {"can": pose((0, 0, 0), model=CAN)}))
    assert set(estimator.inputs()["objects"]) == {"can"}


def two(static=False):
    return {id: pose((0.1, 0.0, 0.0), model=BOX, static=static) for id in ("a", "b")}


def test_a_static_object_is_not_forgotten_for_a_new_one(shapes):
    """``static`` exempts from the age limit, so it is not lost."""
    estimator = Estimator(shapes, Config(tracking={"max_objects": 2}))
    feed(estimator, message(1.0, None, two(static=True)))
    feed(estimator, message(30.0, None, {"c": pose((0.2, 0, 0), model=BOX)}))
    assert [body.id for body in estimator.objects] == ["a", "b"]


def test_making_room_never_fails(shapes):
    """The old one that is forgotten comes back in the same message, without its model."""
    estimator = Estimator(shapes, Config(tracking={"max_objects": 2}))
    feed(estimator, message(0.0, None, two()))
    objects = {"c": pose((0.2, 0, 0), model=BOX), "a": pose((0.1, 0, 0))}
    estimator.update(Observation(t=10.0, objects=objects))
    assert "a" in estimator.inputs()["objects"]


@pytest.mark.parametrize("order", [("a", "c"), ("c", "a")])
@pytest.mark.parametrize("most", [1, 2])
def test_an_object_that_is_seen_again_is_not_forgotten_for_a_new_one(shapes, order, most):
    """Whatever their order in the message."""
    estimator = Estimator(shapes, Config(tracking={"max_objects": most}))
    feed(estimator, message(0.0, None, {"a": pose((0.1, 0.0, 0.0), model=BOX)}))
    objects = {id: pose((0.2, 0, 0), model=BOX) for id in order}
    feed(estimator, message(10.0, None, objects))
    assert sorted(body.id for body in estimator.objects) == ["a", "c"][:most]


def test_one_object_is_measured_against_a_fixed_length(shapes):
    """With one object there is no distance between two: cues.default_spread stands for it."""
    scores = []
    for spread in (0.5, 1.0):
        told = run(stream(1.0, 10), shapes, Config(cues={"default_spread": spread}))[-1]
        scores.append(told.scores["box"]["distance"])
    assert 1.0 - scores[0] == pytest.approx(2.0 * (1.0 - scores[1]))


def test_two_objects_in_one_place_are_a_tie(shapes):
    twins = {id: pose((0.3, 0.0, 0.0), model=BOX) for id in ("one", "two")}
    told = run([{**plain, "objects": twins} for plain in stream(1.0, 10)], shapes)[-1]
    assert told.scores["one"] == told.scores["two"]
    assert (told.target, told.grip, told.confidence) == (None, None, None)


# the whole ---------------------------------------------------------------------------------------


def test_inputs_are_plain_data(shapes):
    estimator = Estimator(shapes)
    assert estimator.inputs() == {"t": 0.0, "counts": {}, "hands": {}, "objects": {}}
    feed(estimator, *stream(1.0, 10))
    plain = {**stream(1.4, 1)[0], "colour": 3}
    plain["objects"] = {"ghost": pose((0, 0, 0), model="ghost", shape=1)}
    plain["hands"]["left"] = hand((0.0, 0.0, 0.0), t=1e6)
    feed(estimator, plain)
    report = json.loads(msgspec.json.encode(estimator.inputs()))
    assert report["t"] == 1.4
    assert report["counts"] == {"messages": 11, "unknown_fields": 2}
    assert report["hands"]["left"]["status"] == "invalid"
    assert report["hands"]["right"]["age"] == 0.0
    assert report["objects"]["box"]["age"] == pytest.approx(0.1)


@pytest.mark.parametrize(("field", "family"), [("targets", "targets"), ("grips", "grip selector")])
def test_unknown_names_list_the_choices(shapes, field, family):
    with pytest.raises(UnknownNameError) as raised:
        Estimator(shapes, Config(**{field: "no such thing"}))
    assert family in str(raised.value)
    assert "no such thing" in str(raised.value)
    known = {"targets": "repaired", "grips": "cylinder"}[field]
    assert known in raised.value.choices
    assert known in str(raised.value)


def test_intentions_of_one_message_are_sorted_by_hand(shapes):
    estimator = Estimator(shapes)
    run(stream(1.0, 5, hands=("b", "d")), shapes, estimator=estimator)
    told = run(stream(1.2, 1, hands=("d", "b", "a", "c")), shapes, estimator=estimator)
    assert [intention.hand for intention in told] == ["a", "b", "c", "d"]
    assert {intention.status for intention in told} > {"warming_up"}


def test_which_hands_have_room_does_not_hang_on_their_order(shapes):
    config = Config(tracking={"max_hands": 2})
    for hands in (("a", "b", "c"), ("c", "b", "a")):
        told = run(stream(1.0, 3, hands=hands), shapes, config)
        assert {intention.hand for intention in told} == {"a", "b"}


def test_updating_does_not_change_what_was_told(shapes):
    estimator = igrip.Estimator(shapes)
    told = run(stream(1.0, 10), shapes, estimator=estimator)
    before = lines(told)
    run(stream(2.0, 10), shapes, estimator=estimator)
    assert lines(told) == before
