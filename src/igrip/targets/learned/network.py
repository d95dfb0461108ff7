"""The learned scorer: the same small networks for every object alike, read from a file of text.

Two questions are learned apart: *which* object it is if it is any, from reaches alone, and
*whether* it is any, from everything that hands do. What gestures teach about none then takes
nothing from telling near from far.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.errors import IgripError
from igrip.learned_weights import numbers, read_learned
from igrip.targets.learned.features import LOCAL, SHARED

Array = NDArray[np.float64]
FORMAT = "igrip-scorer/2"
RIVALRY = 10.0
"""How fast the weight of a rival falls with its angle: exp(10 (cos - 1)), 1/e at 26 degrees."""
HEADING = LOCAL.index("heading_so_far")
INPUTS = (*LOCAL, *(f"{name}_beyond_rivals" for name in LOCAL), *SHARED)
BOUND = 4.0
ABSURD = 3.0
"""An object that is so much less likely (log-odds) than another by *whether* loses by *which*, too:
the one was shown everything, the other only what people reach between (guess)."""


@kernel
def arrange(local, shared, inputs):
    """Write what the network sees of each object: itself, itself less its rivals, the movement.

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
        weight = math.exp(RIVALRY * (local[o, HEADING] - 1.0))
        total += weight
        for k in range(width):
            mean[k] += weight * local[o, k]
    for o in range(objects):
        for k in range(width):
            inputs[o, k] = local[o, k]
            inputs[o, width + k] = local[o, k] - mean[k] / total
        inputs[o, 2 * width :] = shared


@kernel
def evaluate(inputs, mean, scale, hidden, bias, out_weights, out_bias, scores):
    """Write the score of each object: the log-odds of it being the target, against none.

    Parameters
    ----------
    inputs : (o, i)
        As :func:`arrange` writes them.
    mean, scale : (i,), hidden : (i, h), bias : (h,), out_weights : (h, 2), out_bias : (2,)
        The networks; their outputs are which and whether.
    scores : (o,), written
        ``which - log Σ exp which + log Σ exp whether``: the shares of the objects by the one, what
        they have together against none by the other; less what is absurd by the other.
    """
    sums = np.empty(len(bias))
    whether_most = -math.inf
    whether = np.empty(inputs.shape[0])
    for o in range(inputs.shape[0]):
        sums[:] = bias
        for i in range(inputs.shape[1]):
            value = min(max((inputs[o, i] - mean[i]) / scale[i], -BOUND), BOUND)
            for h in range(len(bias)):
                sums[h] += value * hidden[i, h]
        scores[o], whether[o] = out_bias[0], out_bias[1]
        for h in range(len(bias)):
            unit = math.tanh(sums[h])
            scores[o] += out_weights[h, 0] * unit
            whether[o] += out_weights[h, 1] * unit
        whether_most = max(whether_most, whether[o])
    which_sum = whether_sum = 0.0
    which_most = -math.inf
    for o in range(inputs.shape[0]):
        scores[o] += min(0.0, whether[o] - whether_most + ABSURD)
        which_most = max(which_most, scores[o])
    for o in range(inputs.shape[0]):
        which_sum += math.exp(scores[o] - which_most)
        whether_sum += math.exp(whether[o] - whether_most)
    for o in range(inputs.shape[0]):
        scores[o] -= which_most + math.log(which_sum)
        scores[o] += whether_most + math.log(whether_sum)


@dataclass(frozen=True)
class Scorer:
    """The weights, and where they come from.

    Attributes
    ----------
    mean, scale : (i,)
        Inputs are standardised by them, and bounded to ±4.
    hidden : (i, h), bias : (h,)
        Of the hidden layer of tanh units.
    out_weights : (h, 2), out_bias : (2,)
        Of the outputs, which and whether.
    memory : float
        Time constant of the posterior while a hand moves [s].
    provenance : dict
        What it was learned from, and how.
    """

    mean: Array
    scale: Array
    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array
    memory: float
    provenance: dict[str, Any]

    def score(self, local: Array, shared: Array) -> Array:
        """Return the log-odds of each object against none, shape (o,)."""
        inputs = np.empty((len(local), len(INPUTS)))
        arrange(local, shared, inputs)
        scores = np.empty(len(local))
        evaluate(
            inputs, self.mean, self.scale, self.hidden, self.bias, self.out_weights, self.out_bias,
            scores,
        )  # fmt: skip
        return scores


def read_scorer(path: Path) -> Scorer:
    """Read the weights.

    Raises
    ------
    IgripError
        If the file is not of this format, was made for other inputs, or holds other than finite
        numbers of the right shapes.
    """
    told = read_learned(path, FORMAT)
    if tuple(told.get("inputs", ())) != INPUTS:
        raise IgripError(f"{path}: was made for other inputs; train it anew (make train)")
    bias = numbers(told, ["bias"], (-1,), path)
    units = len(bias)
    columns = {
        column: np.stack([numbers(told, ["inputs", name, column], shape, path) for name in INPUTS])
        for column, shape in (("mean", ()), ("scale", ()), ("hidden", (units,)))
    }
    memory = float(numbers(told, ["memory_s"], (), path))
    if not memory > 0.0 or not (columns["scale"] > 0.0).all():
        raise IgripError(f"{path}: scales and memory_s must be positive")
    return Scorer(
        **columns,
        bias=bias,
        out_weights=numbers(told, ["out_weights"], (units, 2), path),
        out_bias=numbers(told, ["out_bias"], (2,), path),
        memory=memory,
        provenance=dict(told.get("provenance", {})),
    )
