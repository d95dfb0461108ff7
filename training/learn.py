"""Fits the scorer: softmax over the objects and none, by stochastic gradient.

The weights are kept on a decimal grid at every step. Differences in the last digits between
machines (other instructions, other orders of summation) are rounded away before they can grow, so
that a second training gives the same file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.targets.learned.network import ABSURD, BOUND, FORMAT, INPUTS, Scorer, arrange
from training.moments import Moments

Array = NDArray[np.float64]
DIGITS = 6  # of the grid
UNITS = 48
WHICH, WHETHER = 2, 2  # networks for each question
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


class Network(NamedTuple):
    """One hidden layer of tanh units, one output."""

    hidden: Array
    bias: Array
    out_weights: Array
    out_bias: Array


def fit_scorer(moments: Moments, memory: float, seed: int) -> tuple[Scorer, float]:
    """Return the scorer and the mean loss of its part that tells whether.

    Networks for *which* learn from frames with a target, between the objects; those for *whether*
    from all, against none. Several that began elsewhere are averaged: each errs in its own way;
    their mean errs less (Hansen & Salamon 1990, IEEE Trans. PAMI 12:993-1001).
    """
    inputs, mean, scale = standardised(inputs_of(moments))
    reached = chosen(moments, moments.target >= 0)
    rows = (moments.target >= 0)[moments.frame]
    which = [fit(inputs[rows], reached, seed + k, none=False)[0] for k in range(WHICH)]
    every = [fit(inputs, moments, seed + WHICH + k, none=True) for k in range(WHETHER)]
    whether = [network for network, _ in every]
    return joined_networks(which, whether, mean, scale, memory), sum(x for _, x in every) / WHETHER


def joined_networks(
    which: Sequence[Network], whether: Sequence[Network], mean: Array, scale: Array, memory: float
) -> Scorer:
    """Return networks side by side, as one."""
    columns = [
        np.concatenate([np.round(n.out_weights / len(part), DIGITS) if part is own else
                        np.zeros_like(n.out_weights) for part in (which, whether) for n in part])
        for own in (which, whether)
    ]  # fmt: skip
    biases = [np.mean([n.out_bias[0] for n in part]) for part in (which, whether)]
    both = [*which, *whether]
    return Scorer(
        mean, scale, np.concatenate([n.hidden for n in both], axis=1),
        np.concatenate([n.bias for n in both]), np.stack(columns, axis=1),
        np.round(np.array(biases), DIGITS), memory, provenance={},
    )  # fmt: skip


def chosen(moments: Moments, keep: NDArray[np.bool_]) -> Moments:
    """Return some of the frames."""
    rows = keep[moments.frame]
    frame, place = np.cumsum(keep) - 1, np.cumsum(rows) - 1
    target = moments.target[keep]
    return Moments(
        moments.local[rows], frame[moments.frame[rows]], moments.shared[keep],
        np.where(target < 0, -1, place[target]), moments.weight[keep], moments.trial[keep],
        moments.part[keep],
    )  # fmt: skip


def fit(
    inputs: Array, moments: Moments, seed: int, none: bool, units: int = UNITS
) -> tuple[Network, float]:
    """Return one network, and its mean loss in the last pass.

    Adam (Kingma & Ba 2015, ICLR) with a learning rate that falls as a cosine.

    Parameters
    ----------
    inputs : (r, i)
        Standardised.
    moments : Moments
        Of the same rows.
    seed : int
        Of the first weights and of the order of the frames.
    none : bool
        Whether none of the objects is an answer, too.
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
    weights = [np.round(w, DIGITS) for w in weights]
    moved = [(np.zeros_like(w), np.zeros_like(w)) for w in weights]
    step, steps = 0, PASSES * -(-len(moments.target) // BATCH)
    for _ in range(PASSES):
        loss = 0.0
        for rows, frame, target, weight in _batches(moments, random):
            gradients, part = _gradients(inputs[rows], frame, target, weight, weights, none)
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
    return Network(*weights), loss / float(moments.weight.sum())


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
    likely = np.exp(np.clip(scores, -50.0, 50.0))
    total = float(none) + np.bincount(frame, weights=likely, minlength=len(target))
    off = likely / total[frame]
    hit = target[target >= 0]
    off[hit] -= 1.0
    off *= weight[frame] / weight.sum()
    loss = float((weight * np.log(total)).sum() - (weight[target >= 0] * scores[hit]).sum())
    back = np.outer(off, out_weights) * (1.0 - units**2)
    return [inputs.T @ back, back.sum(axis=0), units.T @ off, np.array([off.sum()])], loss


def scores_of(scorer: Scorer, inputs: Array, frame: NDArray[np.int64]) -> Array:
    """Return the log-odds of each row against none, as ``network.evaluate``."""
    z = np.clip((inputs - scorer.mean) / scorer.scale, -BOUND, BOUND)
    outputs = np.tanh(z @ scorer.hidden + scorer.bias) @ scorer.out_weights + scorer.out_bias
    which, whether = outputs.T
    most = np.full(frame[-1] + 1 if len(frame) else 0, -np.inf)
    np.maximum.at(most, frame, whether)
    which = which + np.minimum(0.0, whether - most[frame] + ABSURD)
    logs = [np.log(np.bincount(frame, weights=np.exp(np.clip(x, -50.0, 50.0)))) for x in
            (which, whether)]  # fmt: skip
    scores: Array = which - logs[0][frame] + logs[1][frame]
    return scores


def probabilities(scorer: Scorer, inputs: Array, frame: NDArray[np.int64]) -> Array:
    """Return the probability of each object among those of its frame and none, shape (r,)."""
    likely: Array = np.exp(np.clip(scores_of(scorer, inputs, frame), -50.0, 50.0))
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
        f' "out_bias": {json.dumps(scorer.out_bias.tolist())}\n}}\n',
        encoding="utf-8",
    )
