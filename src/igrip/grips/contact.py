"""The paper's grip zones at the predicted place of contact, with a probability.

The paper selects by the *present* position of the hand beside its target (``cylinder``). On its
way a hand is not yet where it will touch: it starts low and rises over the chord. Here a logistic
model reads where the hand is along the object's axis, where it will be, and from which side it
approaches; the probability is averaged over the possible targets. On doubt the paper's rule
decides: the model knows the simulated people that it learned from, the rule knows nobody.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.errors import IgripError
from igrip.geometry.cylinder import Cylinders, axis_of, centre_of, size_of, velocity_of
from igrip.geometry.scene import Geometry
from igrip.grips import GRIPS, Grip, GripConfig
from igrip.grips.cylinder import CylinderGrip
from igrip.learned_weights import numbers, read_learned
from igrip.motion.trajectory import Motion
from igrip.targets import TargetEstimate

Array = NDArray[np.float64]
WEIGHTS = Path(__file__).with_name("contact.json")
FORMAT = "igrip-contact/1"
INPUTS = ("height_now", "height_soon", "height_at_contact", "aside", "descent", "speed_to_go")
N_INPUTS = len(INPUTS)
TERMS = (
    "1", *INPUTS, *(f"{a} {b}" for a, b in combinations_with_replacement(INPUTS, 2)),
)  # fmt: skip
SOON = 0.3  # s
MAX_INPUT, MAX_ODDS = 3.0, 50.0  # bounds


@kernel
def _approaches(position, velocity, cylinders, inputs):
    """Write the result of :func:`approaches`; ``cylinders`` are the rows."""
    for o in range(inputs.shape[0]):
        row = cylinders[o]
        centre, along, moving = centre_of(row), axis_of(row), velocity_of(row)
        half, radius = size_of(row)
        height = rise = out2 = outwards = speed2 = 0.0
        for axis in range(3):
            height += (position[axis] - centre[axis]) * along[axis]
            rise += (velocity[axis] - moving[axis]) * along[axis]
        for axis in range(3):
            away = position[axis] - centre[axis] - height * along[axis]
            moves = velocity[axis] - moving[axis]
            out2 += away * away
            outwards += away * (moves - rise * along[axis])
            speed2 += moves * moves
        out = math.sqrt(out2)
        aside = max(out - radius, 0.0)
        inwards = -outwards / (out + 1e-9)
        speed = math.sqrt(speed2)
        time = min(aside / inwards, 2.0) if inwards > 1e-9 else 0.0
        soon = height + min(SOON, time) * rise
        end = 1.0 if soon >= 0.0 else -1.0
        inputs[o, 0] = end * height / half
        inputs[o, 1] = end * soon / half
        inputs[o, 2] = end * (height + time * rise) / half
        inputs[o, 3] = aside / half
        inputs[o, 4] = -end * rise / (speed + 1e-9)
        inputs[o, 5] = speed * SOON / half
        for k in range(6):
            inputs[o, k] = min(max(inputs[o, k], -MAX_INPUT), MAX_INPUT)


def approaches(position: Array, velocity: Array, cylinders: Cylinders) -> Array:
    """Return how a hand approaches each object, in half-lengths of the object.

    Parameters
    ----------
    position, velocity : (3,)
        Of the hand, world frame [m, m/s].
    cylinders : Cylinders
        Of the objects.

    Returns
    -------
    (o, 6)
        Height along the axis over the middle, now, soon and when the hand will reach the side of
        the cylinder (positive towards the end that it is nearer to soon); distance from the side;
        part of the speed that goes down from that end; how far the hand goes in 0.3 s.
    """
    inputs = np.empty((len(cylinders.rows), len(INPUTS)))
    _approaches(position, velocity, cylinders.rows, inputs)
    return inputs


@kernel
def pinch_odds(inputs, weights):
    """Return the log-odds of a pinch: a polynomial of degree 2 in the inputs, as in TERMS."""
    odds = np.empty(inputs.shape[0])
    for o in range(inputs.shape[0]):
        total, term = weights[0], 1
        for i in range(inputs.shape[1]):
            total += weights[term] * inputs[o, i]
            term += 1
        for i in range(inputs.shape[1]):
            for j in range(i, inputs.shape[1]):
                total += weights[term] * inputs[o, i] * inputs[o, j]
                term += 1
        odds[o] = total
    return odds


@kernel
def _mean_pinch(position, velocity, cylinders, weights, objects):
    """Return the probability of a pinch, over objects with these probabilities."""
    inputs = np.empty((len(cylinders), N_INPUTS))
    _approaches(position, velocity, cylinders, inputs)
    odds = pinch_odds(inputs, weights)
    total = pinched = 0.0
    for o in range(len(cylinders)):
        # it learned from objects that stand: its odds fade as an object is tilted
        own = odds[o] * axis_of(cylinders[o])[2] ** 2
        own = min(max(own, -MAX_ODDS), MAX_ODDS)
        pinched += objects[o] / (1.0 + math.exp(-own))
        total += objects[o]
    return pinched / total


@cache
def weights() -> Array:
    """Return the learned weights, in the order of :data:`TERMS`.

    Raises
    ------
    IgripError
        If the file is not of this format, or was made for other terms.
    """
    content = read_learned(WEIGHTS, FORMAT)
    if tuple(content.get("weights", ())) != TERMS:
        raise IgripError(f"{WEIGHTS}: was made for other terms; retrain it (make train)")
    return np.stack([numbers(content, ["weights", term], (), WEIGHTS) for term in TERMS])


@GRIPS.register("contact")
class ContactGrip:
    """Selects by the paper's rule, unless where the hand will touch makes a grip nearly sure.

    Parameters
    ----------
    config : GripConfig
        ``sure`` is the probability from which the contact point decides.
    learned : (t,) array, optional
        The weights of :data:`TERMS`; by default those that ship.
    """

    def __init__(self, config: GripConfig, learned: Array | None = None) -> None:
        self._weights = weights() if learned is None else learned
        self._sure = config.sure
        self._paper = CylinderGrip(config)

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return the grip and the probability of both; none without a target.

        An estimate without probabilities gives nothing to average over: the paper's rule holds. On
        doubt the grip is the rule's, so it may be the less likely one.
        """
        by_rule = self._paper.select(estimate, geometry, motion)
        if estimate.target is None or estimate.probability is None:
            return by_rule
        probability = _mean_pinch(
            motion.position, motion.velocity, geometry.cylinders().rows, self._weights,
            estimate.probability,
        )  # fmt: skip
        name = by_rule.name
        if max(probability, 1.0 - probability) >= self._sure:
            name = "pinch" if probability >= 0.5 else "palmar"
        return Grip(name, {"palmar": 1.0 - probability, "pinch": probability})
