"""Commands from outside: veto, confirm, released."""

from __future__ import annotations

import contextlib

import pytest

import igrip
from igrip.errors import IgripError
from support import BOX, UPRIGHT


def message(k, *hands):
    return igrip.Observation(
        t=k / 30.0,
        hands={id: {"position": [0.4 * n + 0.001 * k, 0.0, 0.0]} for n, id in enumerate(hands)},
        objects={"box": {"model": BOX, "position": [0.3, 0.0, 0.0], "orientation": UPRIGHT}},
    )


def test_commands_for_unknown_hands_never_block_one_for_a_hand_that_is_followed(shapes):
    estimator = igrip.Estimator(shapes)
    for k in range(1000):
        with contextlib.suppress(IgripError):  # their number has a limit
            estimator.veto(f"unknown-{k}")
    estimator.update(message(0, "right", "left"))
    for command in (estimator.veto, estimator.confirm, estimator.notify_released):
        assert [i.hand for i in command("right")] == ["right"]
    assert [i.hand for i in estimator.veto("left")] == ["left"]
    with pytest.raises(IgripError, match="number of hands has reached its limit"):
        estimator.veto("another")


def test_a_veto_that_comes_before_its_hand_is_kept(shapes):
    config = igrip.Config(targets="paper", commitment={"reliability": 0.0})
    for vetoed in (False, True):
        estimator = igrip.Estimator(shapes, config)
        if vetoed:
            estimator.veto("right")
        leases = 0
        for k in range(40):
            position = [0.005 * k, 0.002 * (k % 3), 0.0]
            objects = {"box": {"model": BOX, "position": [0.4, 0, 0], "orientation": UPRIGHT}}
            one = igrip.Observation(
                t=k / 30.0, hands={"right": {"position": position}}, objects=objects
            )
            leases += sum(i.commitment is not None for i in estimator.update(one))
        assert (leases > 0) is not vetoed
