"""Fit of the predicted times of contact and of the end, by quantile regression.

The loss of a quantile q is the pinball loss max(q e, (q - 1) e) of the error e of the logarithm of
the time (Koenker & Bassett 1978, Econometrica 46:33-50).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.targets.learned.timing import (
    CONTACT_DISTANCE,
    FORMAT,
    INPUTS,
    MAX_INPUT,
    QUANTILES,
    TimingModel,
    timing_inputs,
)
from training.adam import DIGITS, Adam
from training.moments import Frames, Recording
from training.network_file import write_network

Array = NDArray[np.float64]
UNITS, PASSES, BATCH = 32, 12, 1024
MIN_TIME = 0.01  # s; keeps the logarithm finite
KEPT = 0.6  # share of the frames at 30 Hz; neighbours in time are alike


class TimingSamples(NamedTuple):
    """Frames before contact; rows are frames.

    Attributes
    ----------
    inputs : (n, i)
        As the network reads them.
    times : (n, 2)
        Seconds until the contact and until the end.
    weight : (n,)
        Of each frame.
    """

    inputs: Array
    times: Array
    weight: Array


def timing_samples(recording: Recording, frames: Frames) -> TimingSamples:
    """Return the frames of a reach from its onset to its contact, towards the true target."""
    inputs, times = [], []
    contact = contact_time(recording, frames)
    random = np.random.default_rng(len(frames))
    if contact is not None:
        for motion, geometry in frames:
            if not (recording.onset <= motion.t < contact and motion.reach.may_move):
                continue
            ids = [placed.id for placed in geometry.objects]
            if recording.target not in ids or random.random() > KEPT * 30.0 / recording.rate:
                continue
            target = ids.index(str(recording.target))
            inputs.append(timing_inputs(motion, geometry.cylinders().one(target)))
            times.append([contact - motion.t, recording.end - motion.t])
    return TimingSamples(
        np.array(inputs).reshape(-1, len(INPUTS)).round(DIGITS),
        np.maximum(np.array(times).reshape(-1, 2), MIN_TIME).round(DIGITS),
        np.full(len(inputs), recording.weight),
    )


def join_timing(parts: Sequence[TimingSamples]) -> TimingSamples:
    """Return samples of several recordings as one."""
    return TimingSamples(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def contact_time(recording: Recording, frames: Frames) -> float | None:
    """Return when the palm first comes within 8 cm of the target's surface [s]; None: never."""
    before: tuple[float, float] | None = None
    for motion, geometry in frames:
        ids = [placed.id for placed in geometry.objects]
        if recording.target not in ids or motion.t < recording.onset:
            continue
        gap = float(geometry.surface[ids.index(str(recording.target))])
        if gap < CONTACT_DISTANCE:
            if before is None:
                return None  # it began there
            part = (before[1] - CONTACT_DISTANCE) / max(before[1] - gap, 1e-9)
            return before[0] + part * (motion.t - before[0])
        if motion.t > recording.end + 0.25:
            return None
        before = motion.t, gap
    return None


def fit_timing(parts: Sequence[TimingSamples], seed: int) -> TimingModel:
    """Fit the network; every part (a source) weighs the same."""
    shares = [p.weight / p.weight.sum() for p in parts if len(p.weight)]
    weight = np.concatenate(shares)
    weight /= weight.mean()
    inputs = np.concatenate([p.inputs for p in parts])
    times = np.log(np.concatenate([p.times for p in parts]))
    mean = inputs.mean(axis=0).round(DIGITS)
    scale = np.maximum(inputs.std(axis=0), 1e-3).round(DIGITS)
    z = np.clip((inputs - mean) / scale, -MAX_INPUT, MAX_INPUT)
    truth = np.repeat(times, len(QUANTILES), axis=1)
    wanted = np.tile(QUANTILES, 2)
    random = np.random.default_rng(seed)
    width, outputs = z.shape[1], len(wanted)
    adam = Adam(
        [
            random.uniform(-1.0, 1.0, (width, UNITS)) / np.sqrt(width), np.zeros(UNITS),
            random.uniform(-1.0, 1.0, (UNITS, outputs)) / np.sqrt(UNITS),
            np.repeat(np.median(times, axis=0), len(QUANTILES)),
        ],
        PASSES * -(-len(z) // BATCH),
    )  # fmt: skip
    for _ in range(PASSES):
        order = random.permutation(len(z))
        for begin in range(0, len(z), BATCH):
            rows = order[begin : begin + BATCH]
            hidden, bias, out_weights, out_bias = adam.weights
            units = np.tanh(z[rows] @ hidden + bias)
            error = truth[rows] - (units @ out_weights + out_bias)
            slope = np.where(error > 0.0, -wanted, 1.0 - wanted)
            slope *= weight[rows, None] / (weight[rows].sum() * outputs)
            back = (slope @ out_weights.T) * (1.0 - units**2)
            adam.step([z[rows].T @ back, back.sum(axis=0), units.T @ slope, slope.sum(axis=0)])
    return TimingModel(mean, scale, *adam.weights)


def write_timing(model: TimingModel, provenance: dict[str, Any], path: Path) -> None:
    """Write the network as text that can be read and compared."""
    head = {"format": FORMAT, "provenance": provenance, "inputs": INPUTS}
    write_network(head, model._asdict(), path)
