"""Malformed messages and the field that each has to be blamed on."""

from __future__ import annotations

from support import UPRIGHT

P = [0.1, 0.2, 0.3]
NAN, INF = float("nan"), float("inf")


def with_hand(**fields):
    return {"t": 1.0, "hands": {"right": fields}}


def with_object(**fields):
    return {"t": 1.0, "objects": {"mug": {"model": "mug", **fields}}}


HAND, MUG = "hands.right", "objects.mug"

MALFORMED = [
    # time and envelope
    ({}, "t"),
    ({"t": None}, "t"),
    ({"t": "1"}, "t"),
    ({"t": True}, "t"),
    ({"t": [1.0]}, "t"),
    ({"t": {}}, "t"),
    ({"t": NAN}, "t"),
    ({"t": INF}, "t"),
    ({"t": -INF}, "t"),
    ({"t": -1e-9}, "t"),
    ({"t": 10**400}, "t"),
    ({"t": 1.0, "schema": "igrip/2"}, "schema"),
    ({"t": 1.0, "schema": None}, "schema"),
    ({"t": 1.0, "schema": 1}, "schema"),
    ({"t": 1.0, "schema": ["igrip/1"]}, "schema"),
    ({"t": 1.0, "hands": None}, "hands"),
    ({"t": 1.0, "hands": []}, "hands"),
    ({"t": 1.0, "hands": "right"}, "hands"),
    ({"t": 1.0, "objects": [with_object()]}, "objects"),
    ({"t": 1.0, "objects": 3}, "objects"),
    ({"t": 1.0, "objects": {"none": None}}, "objects.none"),
    ({"t": 1.0, "objects": {"none": {"position": P, "orientation": UPRIGHT}}}, "objects.none"),
    ({"t": 1.0, "hands": {"right": P}}, HAND),
    ({"t": 1.0, "hands": {"right": 1}}, HAND),
    ({"t": 1.0, "hands": {"right": "here"}}, HAND),
    ({"t": 1.0, "objects": {"mug": True}}, MUG),
    # what is needed
    (with_hand(), f"{HAND}.position"),
    (with_hand(position=None), f"{HAND}.position"),
    (with_object(orientation=UPRIGHT), f"{MUG}.position"),
    (with_object(position=P), f"{MUG}.orientation"),
    (with_object(position=P, orientation=None), f"{MUG}.orientation"),
    # positions
    (with_hand(position=[]), f"{HAND}.position"),
    (with_hand(position=P[:2]), f"{HAND}.position"),
    (with_hand(position=[*P, 0.0]), f"{HAND}.position"),
    (with_hand(position={"x": 0.1}), f"{HAND}.position"),
    (with_hand(position="0.1"), f"{HAND}.position"),
    (with_hand(position=0.1), f"{HAND}.position"),
    (with_hand(position=[0.1, NAN, 0.3]), f"{HAND}.position[1]"),
    (with_hand(position=[0.1, 0.2, INF]), f"{HAND}.position[2]"),
    (with_hand(position=[-INF, 0.2, 0.3]), f"{HAND}.position[0]"),
    (with_hand(position=[10**400, 0.2, 0.3]), f"{HAND}.position[0]"),
    (with_hand(position=["0.1", 0.2, 0.3]), f"{HAND}.position[0]"),
    (with_hand(position=[0.1, None, 0.3]), f"{HAND}.position[1]"),
    (with_hand(position=[0.1, 0.2, True]), f"{HAND}.position[2]"),
    (with_hand(position=[0.1, 0.2, [0.3]]), f"{HAND}.position[2]"),
    (with_object(position=[NAN, 0, 0], orientation=UPRIGHT), f"{MUG}.position[0]"),
    # rotations
    (with_object(position=P, orientation=[0, 0, 0, 0]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[0, 0, 0, 2]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[0.2, 0, 0, 1]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[0, 0, 1]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[1, 0, 0, 0, 1, 0, 0, 0, 1]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[0, 0, NAN, 1]), f"{MUG}.orientation[2]"),
    (with_object(position=P, orientation=[0, 0, 0, 1e300]), f"{MUG}.orientation"),
    (with_object(position=P, orientation=[1e308, 1e308, 1e308, 1e308]), f"{MUG}.orientation"),
    (with_hand(position=P, orientation=[0, 0, 0, 0.9]), f"{HAND}.orientation"),
    (with_hand(position=P, orientation="up"), f"{HAND}.orientation"),
    # own times
    (with_hand(position=P, t=-0.1), f"{HAND}.t"),
    (with_hand(position=P, t="1"), f"{HAND}.t"),
    (with_hand(position=P, t=NAN), f"{HAND}.t"),
    (with_object(position=P, orientation=UPRIGHT, t=INF), f"{MUG}.t"),
    (with_object(position=P, orientation=UPRIGHT, t=False), f"{MUG}.t"),
    # the optional fields
    (with_hand(position=P, std=-0.1), f"{HAND}.std"),
    (with_hand(position=P, std=NAN), f"{HAND}.std"),
    (with_hand(position=P, std="small"), f"{HAND}.std"),
    (with_hand(position=P, std=True), f"{HAND}.std"),
    (with_hand(position=P, std=[0.1, 0.1]), f"{HAND}.std"),
    (with_hand(position=P, std=[0.1, 0.1, -0.1]), f"{HAND}.std"),
    (with_hand(position=P, std=[0.1, NAN, 0.1]), f"{HAND}.std[1]"),
    (with_hand(position=P, score=NAN), f"{HAND}.score"),
    (with_hand(position=P, score="0.9"), f"{HAND}.score"),
    (with_hand(position=P, source=3), f"{HAND}.source"),
    (with_hand(position=P, landmarks=3), f"{HAND}.landmarks"),
    (with_hand(position=P, landmarks="many"), f"{HAND}.landmarks"),
    (with_hand(position=P, landmarks={"0": P}), f"{HAND}.landmarks"),
    (with_hand(position=P, landmarks=[P, P[:2]]), f"{HAND}.landmarks[1]"),
    (with_hand(position=P, landmarks=[P, P, [0, 0, NAN]]), f"{HAND}.landmarks[2][2]"),
    (with_hand(position=P, landmarks=[P, None]), f"{HAND}.landmarks[1]"),
    (with_object(position=P, orientation=UPRIGHT, static=1), f"{MUG}.static"),
    (with_object(position=P, orientation=UPRIGHT, static="yes"), f"{MUG}.static"),
    (with_object(position=P, orientation=UPRIGHT, static=None), f"{MUG}.static"),
    (with_object(position=P, orientation=UPRIGHT, model=3), f"{MUG}.model"),
    (with_object(position=P, orientation=UPRIGHT, model=["mug"]), f"{MUG}.model"),
    (with_object(position=P, orientation=UPRIGHT, std=[-1, 0, 0]), f"{MUG}.std"),
    (with_object(position=P, orientation=UPRIGHT, score=[1]), f"{MUG}.score"),
    (with_object(position=P, orientation=UPRIGHT, source={}), f"{MUG}.source"),
]
