"""A recording made of intentions written by hand: two hands, and an object called ``left``."""

from __future__ import annotations

import numpy as np

from igrip import Config
from igrip.geometry.scene import PlacedObject, Scene
from igrip.intention import Commitment, Intention
from igrip.objects.catalog import Catalog
from igrip.viewer.snapshot import HandSnapshot, Snapshot
from support import BOX, CAN, placed

STEP = 0.1  # s
END = 4.0
GAP = 0.3  # s; a chart has a gap where a hand is silent for longer
UNDECIDED, DECIDED, LEASED, LOST, OTHER = (
    12,
    18,
    22,
    28,
    36,
)  # numbers of moments, of the right hand


def right_hand(t: float) -> Intention:
    """Rest, move undecided, reach for soup, be lost, reach for the object called ``left``."""
    if t < 0.95:
        chances = {"left": 0.06, "soup": 0.04, "none": 0.9}
        return Intention(t=t, hand="right", status="idle", probability=chances)
    if 2.45 < t < 3.15:
        return Intention(t=t, hand="right", status="lost", reason="out of sight")
    if t < 1.45:
        chances, target, grip = {"left": 0.25, "soup": 0.15, "none": 0.6}, "left", "palmar"
    elif t < 2.45:
        chances, target, grip = {"left": 0.1, "soup": 0.7, "none": 0.2}, "soup", "pinch"
    else:
        chances, target, grip = {"left": 0.55, "soup": 0.05, "none": 0.4}, "left", "palmar"
    lease = Commitment(target=target, grip=grip, since=2.0, valid_until=t + 0.12)
    scores = {id: {"distance": p, "global": p / 2, "distance_derivative": -p}
              for id, p in chances.items() if id != "none"}  # fmt: skip
    return Intention(
        t=t, hand="right", status="reaching", target=target, grip=grip, probability=chances,
        grip_probability={grip: 0.75, "pinch" if grip == "palmar" else "palmar": 0.25},
        confidence=chances[target], time_to_contact=0.8, time_to_contact_interval=(0.5, 1.25),
        commitment=lease if 1.95 < t < 2.45 else None, scores=scores,
    )  # fmt: skip


def left_hand(t: float) -> Intention:
    """Rest all the time."""
    chances = {"left": 0.02 + 0.01 * t, "soup": 0.05, "none": 0.93 - 0.01 * t}
    return Intention(t=t, hand="left", status="idle", probability=chances)


def objects_of(shapes: Catalog) -> list[PlacedObject]:
    """Return the box, called ``left``, and the can."""
    return [
        placed(shapes[BOX], "left", np.eye(3), np.array([-0.2, 0.3, 0.1])),
        placed(shapes[CAN], "soup", np.eye(3), np.array([0.2, 0.3, 0.05])),
    ]


def snapshots_of(shapes: Catalog) -> list[Snapshot]:
    """Return the recording; the left hand is not measured from 1.0 to 2.0 s."""
    objects = objects_of(shapes)
    by_id = {each.id: each for each in objects}
    found = []
    for k in range(round(END / STEP) + 1):
        t = round(k * STEP, 6)
        said = [right_hand(t)] if 0.95 < t < 2.05 else [left_hand(t), right_hand(t)]
        hands = [
            HandSnapshot(
                intention, np.array([[0.1, 0.1 * t, 0.1], [0.1, 0.1 * t + 0.01, 0.1]]), None,
                by_id.get(intention.target or ""), assisted=intention.hand == "right",
            )
            for intention in said
        ]  # fmt: skip
        found.append(Snapshot(t, objects, hands, Scene(Config().rays)))
    return found
