"""The rule of the cylinder, on its own and for a hand beside an object."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frames import geometry
from igrip.geometry.scene import RayConfig, Scene
from igrip.grips import GRIPS, GripConfig
from igrip.grips.cylinder import is_pinch
from igrip.motion.trajectory import Motion
from igrip.targets import TargetEstimate
from oracle import scores
from support import BOX, PAPER, placed, random_turn


def select(target, axial, half_length, **config):
    grip = GRIPS.get("cylinder")(GripConfig(**config))
    frame = geometry(len(axial), axial=axial, half_length=half_length)
    return grip.select(TargetEstimate(target, np.zeros(len(axial))), frame, None)


@given(st.floats(-0.3, 0.3), st.floats(0.01, 0.3))
def test_agrees_with_the_oracle(axial, half_length):
    if abs(abs(axial) - 0.85 * half_length) > 1e-12:
        assert select(0, [axial], [half_length]).name == scores.grip(axial, 2.0 * half_length)


def test_border():
    assert select(0, [0.085], [0.1]).name == "pinch"
    assert select(0, [-0.085], [0.1]).name == "pinch"
    assert select(0, [0.0849], [0.1]).name == "palmar"
    assert select(0, [0.0], [0.1]).name == "palmar"
    assert select(0, [0.5], [0.1]).name == "pinch"
    assert select(0, [0.06], [0.1], pinch_threshold=0.5).name == "pinch"
    assert is_pinch(np.array([0.0, 0.09]), np.array([0.1, 0.1]), 0.85).tolist() == [False, True]


def test_the_grip_is_that_for_the_target():
    assert select(0, [0.0, 0.2], [0.1, 0.1]).name == "palmar"
    assert select(1, [0.0, 0.2], [0.1, 0.1]).name == "pinch"


def test_without_a_target_there_is_no_grip():
    grip = select(None, [0.0], [0.1])
    assert grip.name is None
    assert grip.probability is None


@pytest.mark.parametrize("name", PAPER)
def test_beside_palmar_above_and_below_pinch(ycb, name):
    """A hand round a real object that stands anywhere, turned anyhow."""
    model = ycb[name]
    rng = np.random.default_rng(1)
    turn, shift = random_turn(rng), rng.uniform(-1.0, 1.0, 3)
    body = placed(model, name, turn.as_matrix(), shift)
    grip = GRIPS.get("cylinder")(GripConfig())
    half = 0.5 * model.length
    for height, expected in ((-1.2, "pinch"), (-0.9, "pinch"), (-0.8, "palmar"), (0.0, "palmar"),
                             (0.8, "palmar"), (0.9, "pinch"), (1.2, "pinch")):  # fmt: skip
        side = np.cross(model.axis, rng.normal(size=3))
        local = model.origin + height * half * model.axis + 0.1 * side / np.linalg.norm(side)
        [measured] = Scene(RayConfig()).measure([at(turn.apply(local) + shift)], [body])
        assert grip.select(TargetEstimate(0, np.ones(1)), measured, None).name == expected


def at(position):
    """Return the motion of a hand that rests at a position."""
    zero = np.zeros((3, 3))
    return Motion(0.0, position, zero, zero[0], 0.0, None, np.tile(position, (10, 1)),
                  np.zeros((10, 3)), None)  # fmt: skip


def test_the_full_length_would_put_the_border_outside(shapes):
    """The paper's L is the full length; its own figure shows the border inside the object."""
    half = 0.5 * shapes[BOX].length
    assert 0.85 * half < half < 0.85 * shapes[BOX].length
