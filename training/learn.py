"""Fit of the scorer: softmax over the objects and none, by stochastic gradient."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.targets.learned.network import (
    FORMAT,
    INPUTS,
    MAX_DEFICIT,
    MAX_INPUT,
    Layers,
    Scorer,
    arrange_inputs,
)
from training.adam import DIGITS, Adam
from training.moments import Moments, selected

Array = NDArray[np.float64]
UNITS = 48
PASSES, BATCH = 15, 2048  # fewer passes: less certain of what no other source confirms


def inputs_of(moments: Moments) -> Array:
    """Return the inputs of the network, a row for each frame × object."""
    inputs = np.empty((len(moments.local), len(INPUTS)))
    edges = np.append(np.flatnonzero(np.diff(moments.frame, prepend=-1)), len(moments.frame))
    for n, (first, last) in enumerate(pairwise(edges.tolist())):
        arrange_inputs(moments.local[first:last], moments.shared[n], inputs[first:last])
    return inputs


def standardised(inputs: Array) -> tuple[Array, Array, Array]:
    """Return the inputs as the network takes them, and their mean and scale."""
    mean = np.round(inputs.mean(axis=0), DIGITS)
    scale = np.round(np.maximum(inputs.std(axis=0), 1e-3), DIGITS)
    return np.clip((inputs - mean) / scale, -MAX_INPUT, MAX_INPUT), mean, scale


class Network(NamedTuple):
    """One hidden layer of tanh units, one output."""

    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array


def fit_scorer(moments: Moments, memory: float, seed: int) -> tuple[Scorer, float]:
    """Return the scorer and the mean loss of its reach-detection head.

    The network of the target head learns from frames with a target, between the objects; that of
    the reach-detection head from all frames, against none.
    """
    inputs, mean, scale = standardised(inputs_of(moments))
    reaching = moments.target >= 0
    reaches, rows = selected(moments, reaching), reaching[moments.frame]
    target, _ = fit(inputs[rows], reaches, seed, none=False)
    reach, loss = fit(inputs, moments, seed + 1, none=True)
    return Scorer(joined_networks(target, reach, mean, scale), memory, {}), loss


def joined_networks(target: Network, reach: Network, mean: Array, scale: Array) -> Layers:
    """Return the networks of both heads side by side, as one."""
    nothing = np.zeros(len(target.out_weights))
    columns = [
        np.concatenate([target.out_weights, nothing]),
        np.concatenate([nothing, reach.out_weights]),
    ]
    return Layers(
        mean, scale, np.concatenate([target.hidden, reach.hidden], axis=1),
        np.concatenate([target.bias, reach.bias]), np.stack(columns, axis=1),
        np.array([target.out_bias[0], reach.out_bias[0]]),
    )  # fmt: skip


def fit(
    inputs: Array, moments: Moments, seed: int, none: bool, units: int = UNITS
) -> tuple[Network, float]:
    """Return one network, and its mean loss in the last pass.

    Parameters
    ----------
    inputs : (r, i)
        Standardised.
    moments : Moments
        Of the same rows.
    seed : int
        Of the first weights and of the order of the frames.
    none : bool
        Whether none of the objects is a class, too.
    units : int
        Of the hidden layer.
    """
    random = np.random.default_rng(seed)
    width = inputs.shape[1]
    weights = [
        random.uniform(-1.0, 1.0, (width, units)) / np.sqrt(width),
        np.zeros(units),
        random.uniform(-1.0, 1.0, units) / np.sqrt(units),
        np.zeros(1),
    ]
    adam = Adam(weights, PASSES * -(-len(moments.target) // BATCH))
    for _ in range(PASSES):
        loss = 0.0
        for rows, frame, target, weight in _batches(moments, random):
            gradients, part = _gradients(inputs[rows], frame, target, weight, adam.weights, none)
            loss += part
            adam.step(gradients)
    return Network(*adam.weights), loss / float(moments.weight.sum())


def _batches(
    moments: Moments, random: np.random.Generator
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Array]]:
    """Yield rows, the frame of each, the target's place among the rows (-1: none), and weights."""
    counts = np.bincount(moments.frame, minlength=len(moments.target))
    firsts = np.cumsum(counts) - counts
    order = random.permutation(len(moments.target))
    for begin in range(0, len(order), BATCH):
        frames = order[begin : begin + BATCH]
        size = counts[frames]
        ends = np.cumsum(size)
        rows = np.arange(ends[-1]) + np.repeat(firsts[frames] - (ends - size), size)
        target = moments.target[frames]
        place = np.where(target < 0, -1, target - firsts[frames] + (ends - size))
        yield rows, np.repeat(np.arange(len(frames)), size), place, moments.weight[frames]


def _gradients(
    inputs: Array, frame: NDArray[np.int64], target: NDArray[np.int64], weight: Array,
    weights: list[Array], none: bool,
) -> tuple[list[Array], float]:  # fmt: skip
    """Return the gradient of the mean loss for each array of weights, and the loss's sum."""
    hidden, bias, out_weights, out_bias = weights
    units = np.tanh(inputs @ hidden + bias)
    scores = units @ out_weights + out_bias
    likelihood = np.exp(np.clip(scores, -50.0, 50.0))
    total = float(none) + np.bincount(frame, weights=likelihood, minlength=len(target))
    off = likelihood / total[frame]
    hit = target[target >= 0]
    off[hit] -= 1.0
    off *= weight[frame] / weight.sum()
    loss = float((weight * np.log(total)).sum() - (weight[target >= 0] * scores[hit]).sum())
    back = np.outer(off, out_weights) * (1.0 - units**2)
    return [inputs.T @ back, back.sum(axis=0), units.T @ off, np.array([off.sum()])], loss


def scores_of(scorer: Scorer, inputs: Array, frame: NDArray[np.int64]) -> Array:
    """Return the log-odds of each row against none, as ``network.evaluate``."""
    layers = scorer.layers
    z = np.clip((inputs - layers.mean) / layers.scale, -MAX_INPUT, MAX_INPUT)
    outputs = np.tanh(z @ layers.hidden + layers.bias) @ layers.out_weights + layers.out_bias
    target, reach = outputs.T
    max_reach = np.full(frame[-1] + 1 if len(frame) else 0, -np.inf)
    np.maximum.at(max_reach, frame, reach)
    target = target + np.minimum(0.0, reach - max_reach[frame] + MAX_DEFICIT)
    target_log, reach_log = (
        np.log(np.bincount(frame, weights=np.exp(np.clip(head, -50.0, 50.0))))
        for head in (target, reach)
    )
    scores: Array = target - target_log[frame] + reach_log[frame]
    return scores


def probabilities(scorer: Scorer, inputs: Array, frame: NDArray[np.int64]) -> Array:
    """Return the probability of each object among those of its frame and none, shape (r,)."""
    odds: Array = np.exp(np.clip(scores_of(scorer, inputs, frame), -50.0, 50.0))
    return odds / (1.0 + np.bincount(frame, weights=odds))[frame]


def write_scorer(scorer: Scorer, path: Path) -> None:
    """Write the weights as JSON that can be read and compared line by line."""
    layers = scorer.layers
    head = {"format": FORMAT, "provenance": scorer.provenance, "memory_s": scorer.memory}
    rows = [
        json.dumps({"mean": mean, "scale": scale, "hidden": hidden})
        for mean, scale, hidden in zip(
            layers.mean.tolist(), layers.scale.tolist(), layers.hidden.tolist(), strict=True
        )
    ]
    inputs = ",\n".join(f'  "{name}": {row}' for name, row in zip(INPUTS, rows, strict=True))
    path.write_text(
        f"{json.dumps(head, indent=1)[:-2]},\n"
        f' "inputs": {{\n{inputs}\n }},\n'
        f' "bias": {json.dumps(layers.bias.tolist())},\n'
        f' "out_weights": {json.dumps(layers.out_weights.tolist())},\n'
        f' "out_bias": {json.dumps(layers.out_bias.tolist())}\n}}\n',
        encoding="utf-8",
    )
