"""Fits the scorer: softmax over the objects and none, by stochastic gradient.

The weights are kept on a decimal grid at every step. Differences in the last digits between
machines (other instructions, other orders of summation) are rounded away before they can grow, so
that a second training gives the same file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from igrip.targets.network import BOUND, FORMAT, INPUTS, Scorer, arrange, evaluate
from training.moments import Moments

Array = NDArray[np.float64]
DIGITS = 6  # of the grid
UNITS, NETWORKS = 48, 3
PASSES, BATCH, RATE, DECAY = 60, 2048, 4e-3, 1e-4
FIRST, SECOND = 0.9, 0.999  # memory of the gradient and of its square


def inputs_of(moments: Moments) -> Array:
    """Return what the network sees, a row for each frame × object."""
    inputs = np.empty((len(moments.local), len(INPUTS)))
    edges = np.append(np.flatnonzero(np.diff(moments.frame, prepend=-1)), len(moments.frame))
    for n, (first, last) in enumerate(pairwise(edges.tolist())):
        arrange(moments.local[first:last], moments.shared[n], inputs[first:last])
    return inputs


def standardised(inputs: Array) -> tuple[Array, Array, Array]:
    """Return the inputs as the network takes them, and their mean and scale."""
    mean = np.round(inputs.mean(axis=0), DIGITS)
    scale = np.round(np.maximum(inputs.std(axis=0), 1e-3), DIGITS)
    return np.clip((inputs - mean) / scale, -BOUND, BOUND), mean, scale


def fit_several(moments: Moments, memory: float, seed: int) -> tuple[Scorer, float]:
    """Return the mean of several networks that began elsewhere, and their mean loss.

    Side by side they are one network. Each errs in its own way; their mean errs less (Hansen &
    Salamon 1990, IEEE Trans. PAMI 12:993-1001).
    """
    every = [fit(moments, memory, seed + k) for k in range(NETWORKS)]
    scorers = [scorer for scorer, _ in every]
    several = Scorer(
        scorers[0].mean, scorers[0].scale,
        np.concatenate([s.hidden for s in scorers], axis=1),
        np.concatenate([s.bias for s in scorers]),
        np.round(np.concatenate([s.out_weights for s in scorers]) / NETWORKS, DIGITS),
        round(sum(s.out_bias for s in scorers) / NETWORKS, DIGITS), memory, provenance={},
    )  # fmt: skip
    return several, sum(loss for _, loss in every) / NETWORKS


def fit(moments: Moments, memory: float, seed: int, units: int = UNITS) -> tuple[Scorer, float]:
    """Return a scorer of one network, and its mean loss in the last pass.

    Adam (Kingma & Ba 2015, ICLR) with a learning rate that falls as a cosine.
    """
    inputs, mean, scale = standardised(inputs_of(moments))
    random = np.random.default_rng(seed)
    width = inputs.shape[1]
    weights = [
        random.uniform(-1.0, 1.0, (width, units)) / np.sqrt(width),
        np.zeros(units),
        random.uniform(-1.0, 1.0, units) / np.sqrt(units),
        np.zeros(1),
    ]
    weights = [np.round(w, DIGITS) for w in weights]
    moved = [(np.zeros_like(w), np.zeros_like(w)) for w in weights]
    step, steps = 0, PASSES * -(-len(moments.target) // BATCH)
    for _ in range(PASSES):
        loss = 0.0
        for rows, frame, target, weight in _batches(moments, random):
            gradients, part = _gradients(inputs[rows], frame, target, weight, weights)
            loss += part
            step += 1
            rate = RATE * 0.5 * (1.0 + np.cos(np.pi * step / steps))
            for k, gradient in enumerate(gradients):
                one, two = moved[k]
                gradient = gradient + DECAY * weights[k]
                one += (1.0 - FIRST) * (gradient - one)
                two += (1.0 - SECOND) * (gradient**2 - two)
                slope = one / (1.0 - FIRST**step)
                size = np.sqrt(two / (1.0 - SECOND**step)) + 1e-8
                weights[k] = np.round(weights[k] - rate * slope / size, DIGITS)
    hidden, bias, out_weights, out_bias = weights
    scorer = Scorer(
        mean, scale, hidden, bias, out_weights, float(out_bias[0]), memory, provenance={}
    )
    return scorer, loss / float(moments.weight.sum())


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
    weights: list[Array],
) -> tuple[list[Array], float]:  # fmt: skip
    """Return the gradient of the mean loss for each array of weights, and the loss's sum."""
    hidden, bias, out_weights, out_bias = weights
    units = np.tanh(inputs @ hidden + bias)
    scores = units @ out_weights + out_bias
    likely = np.exp(np.clip(scores, -50.0, 50.0))
    total = 1.0 + np.bincount(frame, weights=likely, minlength=len(target))
    off = likely / total[frame]
    hit = target[target >= 0]
    off[hit] -= 1.0
    off *= weight[frame] / weight.sum()
    loss = float((weight * np.log(total)).sum() - (weight[target >= 0] * scores[hit]).sum())
    back = np.outer(off, out_weights) * (1.0 - units**2)
    return [inputs.T @ back, back.sum(axis=0), units.T @ off, np.array([off.sum()])], loss


def scores_of(scorer: Scorer, inputs: Array) -> Array:
    """Return the log-odds of each row, shape (r,)."""
    scores = np.empty(len(inputs))
    evaluate(
        inputs, scorer.mean, scorer.scale, scorer.hidden, scorer.bias, scorer.out_weights,
        scorer.out_bias, scores,
    )  # fmt: skip
    return scores


def probabilities(scorer: Scorer, inputs: Array, frame: NDArray[np.int64]) -> Array:
    """Return the probability of each object among those of its frame and none, shape (r,)."""
    likely: Array = np.exp(np.clip(scores_of(scorer, inputs), -50.0, 50.0))
    return likely / (1.0 + np.bincount(frame, weights=likely))[frame]


def write_scorer(scorer: Scorer, path: Path) -> None:
    """Write the weights as text that can be read and compared line by line."""
    head = {"format": FORMAT, "provenance": scorer.provenance, "memory_s": scorer.memory}
    rows = [
        json.dumps({"mean": mean, "scale": scale, "hidden": hidden})
        for mean, scale, hidden in zip(
            scorer.mean.tolist(), scorer.scale.tolist(), scorer.hidden.tolist(), strict=True
        )
    ]
    inputs = ",\n".join(f'  "{name}": {row}' for name, row in zip(INPUTS, rows, strict=True))
    path.write_text(
        f"{json.dumps(head, indent=1)[:-2]},\n"
        f' "inputs": {{\n{inputs}\n }},\n'
        f' "bias": {json.dumps(scorer.bias.tolist())},\n'
        f' "out_weights": {json.dumps(scorer.out_weights.tolist())},\n'
        f' "out_bias": {scorer.out_bias}\n}}\n',
        encoding="utf-8",
    )
