"""When a reach ends: a learned prediction of the times of contact and of the end, with intervals.

A small network reads the features of the movement towards its target, the time since the onset and
the distance that is left, and returns the 10 %, 50 % and 90 % quantiles of the logarithms of both
times (quantile regression, Koenker & Bassett 1978).
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.errors import IgripError
from igrip.geometry.cylinder import Cylinders, distance_from
from igrip.learned_weights import layers, read_learned
from igrip.motion.trajectory import Motion
from igrip.targets.learned.features import LOCAL, SHARED, features_of

Array = NDArray[np.float64]
FORMAT = "igrip-timing/1"
FILE = Path(__file__).with_name("timing.json")
INPUTS = (*LOCAL, *SHARED, "log_elapsed", "log_distance")
QUANTILES = (0.1, 0.5, 0.9)
CONTACT_DISTANCE = 0.08  # m from palm to surface at which a grasp makes contact
MIN_ELAPSED, MIN_DISTANCE = 0.03, 0.02  # s, m: keep the logarithms finite
MAX_INPUT = 4.0


class Prediction(NamedTuple):
    """Seconds from the newest measurement on.

    Attributes
    ----------
    low, median, high : float
        Quantiles 10 %, 50 % and 90 %; so the interval holds the truth in 80 % of cases.
    """

    low: float
    median: float
    high: float

    @property
    def interval(self) -> tuple[float, float]:
        """The 10 % and 90 % quantiles [s]."""
        return self.low, self.high

    def after(self, seconds: float) -> Prediction:
        """Return the same seen from a later moment; never negative."""
        low, median, high = self
        return Prediction(
            max(0.0, low - seconds), max(0.0, median - seconds), max(0.0, high - seconds)
        )


class Timing(NamedTuple):
    """When a hand comes within 8 cm of its target's surface, and when its movement ends."""

    contact: Prediction
    end: Prediction


@kernel
def _arrange(local, shared, elapsed, cylinder, position, inputs):
    """Write the result of :func:`timing_inputs`."""
    inputs[: len(local)] = local
    inputs[len(local) : -2] = shared
    inputs[-2] = math.log(elapsed + MIN_ELAPSED)
    inputs[-1] = math.log(distance_from(cylinder, position) + MIN_DISTANCE)


@kernel
def _evaluate(inputs, mean, scale, hidden, bias, out_weights, out_bias):
    """Return the quantiles of both times, sorted [s]."""
    outputs = out_bias.copy()
    for h in range(len(bias)):
        total = bias[h]
        for i in range(len(inputs)):
            value = (inputs[i] - mean[i]) / scale[i]
            total += min(max(value, -MAX_INPUT), MAX_INPUT) * hidden[i, h]
        unit = math.tanh(total)
        for k in range(len(outputs)):
            outputs[k] += unit * out_weights[h, k]
    return (
        _in_order(outputs[0], outputs[1], outputs[2]), _in_order(outputs[3], outputs[4], outputs[5])
    )  # fmt: skip


@kernel
def _in_order(a, b, c):
    """Return the times of three logarithms, the shortest first: quantiles may cross."""
    low, high = min(a, b), max(a, b)
    middle = min(max(low, c), high)
    return math.exp(min(low, c)), math.exp(middle), math.exp(max(high, c))


def timing_inputs(motion: Motion, target: Cylinders) -> Array:
    """Return what the network reads, in the order of :data:`INPUTS`.

    Parameters
    ----------
    motion : Motion
        Of a hand that moves or may have begun to.
    target : Cylinders
        The one cylinder of its target.
    """
    features, inputs = features_of(motion.reach, target), np.empty(len(INPUTS))
    elapsed = motion.reach.elapsed
    _arrange(features.local[0], features.shared, elapsed, target.rows[0], motion.position, inputs)
    return inputs


class TimingModel(NamedTuple):
    """The network.

    Attributes
    ----------
    mean, scale : (i,)
        Inputs are standardised by them, and bounded to ±4.
    hidden : (i, h), bias : (h,)
        Of the hidden layer of tanh units.
    out_weights : (h, 6), out_bias : (6,)
        Of the outputs: three quantiles of the time to contact, three of that to the end.
    """

    mean: Array
    scale: Array
    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array

    def predict(self, motion: Motion, target: Cylinders) -> Timing:
        """Return the times for a hand that may move, from the one cylinder of its target."""
        return self.evaluate(timing_inputs(motion, target))

    def evaluate(self, inputs: Array) -> Timing:
        """Return the times from the inputs, shape (i,)."""
        contact, end = _evaluate(inputs, *self)
        return Timing(Prediction(*contact), Prediction(*end))


@cache
def default_timing() -> TimingModel:
    """Return the network that ships."""
    return read_timing(FILE)


def read_timing(path: Path) -> TimingModel:
    """Read the network.

    Raises
    ------
    IgripError
        If the file is not of this format, or was made for other inputs.
    """
    content = read_learned(path, FORMAT)
    if tuple(content.get("inputs", ())) != INPUTS:
        raise IgripError(f"{path}: was made for other inputs; retrain it (make train)")
    return TimingModel(*layers(content, len(INPUTS), 2 * len(QUANTILES), path))
