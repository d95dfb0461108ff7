"""The learned scorer: the same small networks for every object alike, read from a JSON file.

It has two heads. The *target head* distinguishes the objects and is learned from reaches alone; the
*reach-detection head* distinguishes a reach for any object from everything else that hands do, and
is learned from all movements. What gestures teach about *none* thus does not disturb the
discrimination of near from far.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.errors import IgripError
from igrip.learned_weights import numbers, read_learned
from igrip.targets.learned.features import LOCAL, SHARED, Features

Array = NDArray[np.float64]
FORMAT = "igrip-scorer/2"
RIVAL_SHARPNESS = 10.0
"""The weight of a rival falls with its angle as exp(10 (cos - 1)): 1/e at 26 degrees."""
HEADING = LOCAL.index("heading_so_far")
INPUTS = (*LOCAL, *(f"{name}_beyond_rivals" for name in LOCAL), *SHARED)
MAX_INPUT = 4.0
"""Bound of the standardised inputs."""
MAX_DEFICIT = 3.0
"""Log-odds by which an object may be less likely than the best by the reach-detection head before
it loses by the target head, too: the latter never saw what people do not reach between (guess)."""


@kernel
def arrange_inputs(local, shared, inputs):
    """Write the inputs of each object: its features, those minus its rivals', the movement's.

    The rivals' mean (the object among them) is weighted by how well they lie in the direction of
    the movement, so that clutter elsewhere changes nothing.

    Parameters
    ----------
    local : (o, l), shared : (s,)
        Of :mod:`igrip.targets.learned.features`.
    inputs : (o, 2 l + s), written
        In the order of :data:`INPUTS`.
    """
    objects, width = local.shape
    total = 0.0
    mean = np.zeros(width)
    for o in range(objects):
        weight = math.exp(RIVAL_SHARPNESS * (local[o, HEADING] - 1.0))
        total += weight
        for k in range(width):
            mean[k] += weight * local[o, k]
    for o in range(objects):
        for k in range(width):
            inputs[o, k] = local[o, k]
            inputs[o, width + k] = local[o, k] - mean[k] / total
        inputs[o, 2 * width :] = shared


class Layers(NamedTuple):
    """The numbers of the networks, side by side.

    Attributes
    ----------
    mean, scale : (i,)
        Inputs are standardised by them, and bounded to ±4.
    hidden : (i, h), bias : (h,)
        Of the hidden layer of tanh units.
    out_weights : (h, 2), out_bias : (2,)
        Of the outputs: target head, reach-detection head.
    """

    mean: Array
    scale: Array
    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array


@kernel
def evaluate(inputs, mean, scale, hidden, bias, out_weights, out_bias, target):
    """Write the score of each object: the log-odds of it being the target, against none.

    ``score = target - log Σ exp target + log Σ exp reach``: the target head shares out among the
    objects what they have together against none by the reach-detection head. Objects that the
    latter finds far less likely than the best lose by the target head as well.

    Parameters
    ----------
    inputs : (o, i)
        As :func:`arrange_inputs` writes them.
    mean, scale, hidden, bias, out_weights, out_bias : arrays
        The fields of :class:`Layers`: numba reads arrays faster than named tuples.
    target : (o,), written
        Log-odds; on the way, the output of the target head.
    """
    objects, units = inputs.shape[0], len(bias)
    sums, reach = np.empty(units), np.empty(objects)
    max_reach = max_target = -math.inf
    for o in range(objects):
        sums[:] = bias
        for i in range(inputs.shape[1]):
            value = (inputs[o, i] - mean[i]) / scale[i]
            value = min(max(value, -MAX_INPUT), MAX_INPUT)
            for h in range(units):
                sums[h] += value * hidden[i, h]
        target[o], reach[o] = out_bias[0], out_bias[1]
        for h in range(units):
            unit = math.tanh(sums[h])
            target[o] += out_weights[h, 0] * unit
            reach[o] += out_weights[h, 1] * unit
        max_reach = max(max_reach, reach[o])
    target_sum = reach_sum = 0.0
    for o in range(objects):
        target[o] += min(0.0, reach[o] - max_reach + MAX_DEFICIT)
        max_target = max(max_target, target[o])
    for o in range(objects):
        target_sum += math.exp(target[o] - max_target)
        reach_sum += math.exp(reach[o] - max_reach)
    for o in range(objects):
        target[o] -= max_target + math.log(target_sum)
        target[o] += max_reach + math.log(reach_sum)


@dataclass(frozen=True)
class Scorer:
    """The networks, and where they come from.

    Attributes
    ----------
    layers : Layers
        The numbers.
    memory : float
        Time constant of the posterior while a hand moves [s].
    provenance : dict
        What it was learned from, and how.
    """

    layers: Layers
    memory: float
    provenance: dict[str, Any]

    def score(self, features: Features) -> Array:
        """Return the log-odds of each object against none, shape (o,)."""
        inputs = np.empty((len(features.local), len(INPUTS)))
        arrange_inputs(features.local, features.shared, inputs)
        scores = np.empty(len(inputs))
        evaluate(inputs, *self.layers, scores)
        return scores


def read_scorer(path: Path) -> Scorer:
    """Read a scorer from a file.

    Raises
    ------
    IgripError
        If the file is not of this format, was made for other inputs, or holds other than finite
        numbers of the right shapes.
    """
    content = read_learned(path, FORMAT)
    if tuple(content.get("inputs", ())) != INPUTS:
        raise IgripError(f"{path}: was made for other inputs; retrain it (make train)")
    bias = numbers(content, ["bias"], (-1,), path)
    units = len(bias)
    columns = {
        column: np.stack(
            [numbers(content, ["inputs", name, column], shape, path) for name in INPUTS]
        )
        for column, shape in (("mean", ()), ("scale", ()), ("hidden", (units,)))
    }
    memory = float(numbers(content, ["memory_s"], (), path))
    if not memory > 0.0 or not (columns["scale"] > 0.0).all():
        raise IgripError(f"{path}: scales and memory_s must be positive")
    layers = Layers(
        **columns,
        bias=bias,
        out_weights=numbers(content, ["out_weights"], (units, 2), path),
        out_bias=numbers(content, ["out_bias"], (2,), path),
    )
    return Scorer(layers, memory, dict(content.get("provenance", {})))
