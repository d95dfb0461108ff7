"""Hands that several detectors measured, as one: weighted by what each says of its own error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from igrip.entities import Hand
from igrip.perception.hands import LANDMARKS, HandDetection
from igrip.rgbd import Array

MIN_GATE = 0.10  # m within which two measurements are of one hand: half a hand and a palm; guess
DEVIATIONS = 4.0  # or so many of both their standard deviations
FLOOR = 0.004  # m; no detector knows the middle of a palm better; guess


def fuse(groups: Sequence[tuple[str, Sequence[HandDetection]]], camera: str) -> list[HandDetection]:
    """Return the hands of several detectors, each hand once, the surest first.

    Parameters
    ----------
    groups : sequence of (str, sequence of HandDetection)
        The name of each detector and what it measured, all with ``measured``; one detector reports
        each hand once. The first that shows a hand gives its landmarks and label.
    camera : str
        Whose frame it was; ``source`` then is its name and those of the detectors, the one that
        weighs most first.
    """
    hands: list[list[tuple[str, HandDetection]]] = []
    for name, detections in groups:
        for hand, detection in _matched(hands, detections):
            if hand is None:
                hands.append([(name, detection)])
            else:
                hand.append((name, detection))
    return sorted((_merged(hand, camera) for hand in hands), key=lambda hand: -hand.score)


def _matched(
    hands: list[list[tuple[str, HandDetection]]], detections: Sequence[HandDetection]
) -> list[tuple[list[tuple[str, HandDetection]] | None, HandDetection]]:
    """Return to which known hand each detection belongs, or None: to a new one."""
    if not hands or not detections:
        return [(None, detection) for detection in detections]
    cost = np.zeros((len(hands), len(detections)))
    allowed = np.zeros(cost.shape, dtype=np.bool_)
    for i, hand in enumerate(hands):
        for j, detection in enumerate(detections):
            ones = [np.linalg.norm(_position(one) - _position(detection)) for _, one in hand]
            gates = [
                max(MIN_GATE, DEVIATIONS * float(np.hypot(_std(one).max(), _std(detection).max())))
                for _, one in hand
            ]
            cost[i, j] = min(ones)
            allowed[i, j] = any(gap < gate for gap, gate in zip(ones, gates, strict=True))
    rows, columns = linear_sum_assignment(np.where(allowed, cost, 1e3))
    found = {int(j): hands[int(i)] for i, j in zip(rows, columns, strict=True) if allowed[i, j]}
    return [(found.get(j), detection) for j, detection in enumerate(detections)]


def _merged(hand: list[tuple[str, HandDetection]], camera: str) -> HandDetection:
    """Return one hand by the inverse of each variance."""
    weights = np.stack([1.0 / np.maximum(_std(one), FLOOR) ** 2 for _, one in hand])
    places = np.stack([_position(one) for _, one in hand])
    total = weights.sum(axis=0)
    x, y, z = ((weights * places).sum(axis=0) / total).tolist()
    a, b, c = (1.0 / np.sqrt(total)).tolist()
    order = np.argsort(-weights.sum(axis=1), kind="stable")
    names = "+".join(hand[int(k)][0] for k in order)
    first = next((one for _, one in hand if len(one.landmarks) == LANDMARKS), hand[0][1])
    label = next((one.label for _, one in hand if one.label is not None), None)
    score = max(one.score for _, one in hand)
    shown = first.measured
    assert shown is not None
    measured = Hand(
        position=(x, y, z), t=shown.t, landmarks=shown.landmarks, std=(a, b, c), score=score,
        source=f"{camera} {names}",
    )  # fmt: skip
    return HandDetection(first.landmarks, score, label, measured)


def _position(hand: HandDetection) -> Array:
    assert hand.measured is not None
    return np.array(hand.measured.position)


def _std(hand: HandDetection) -> Array:
    assert hand.measured is not None
    std = hand.measured.std
    return np.broadcast_to(np.array(0.01 if std is None else std, dtype=np.float64), (3,))
