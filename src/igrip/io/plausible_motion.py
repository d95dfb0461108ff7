"""How a hand moves: faster than any hand does, or sent more often than it is measured."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from igrip.io.findings import Array, Finding, Samples
from igrip.io.fitting_units import fix_by, format_number, question
from igrip.io.frames import METRES

MAX_SPEED = 30.0  # m/s, as the median of a moving hand; more is remarked
MIN_SAMPLES = 5  # fewer show nothing
REPEATED_SHARE = 0.5  # of positions that repeat the one before, bit for bit
MAX_REPEATS = 8  # in a row; more are a rest
MAX_EXTENT = 20.0  # m that a hand or object may move; more is refused
MAX_REACH, MAX_REACH_SPEED = 2.0, 5.0  # m and m/s; what exceeds both is remarked
WIDE, FAST = 4.0, 6.0  # m and m/s; what exceeds both is refused: nobody runs so while grasping
USUAL_EXTENT = 0.5  # m
FAST_SHARE = 0.1  # of the steps that are as fast
SWEEP_INTERVAL = 0.03  # s over which its speed is measured
STEADY_SHARE = 0.8  # of them that go on where the one before went


def check_motion(id: str, samples: Samples, unit: str) -> list[Finding]:
    """Check the speed of a hand, and the share of positions that repeat the one before."""
    seen = np.isfinite(samples.positions).all(axis=1) & np.isfinite(samples.times)
    times, points = samples.times[seen], samples.positions[seen]
    if len(times) < 2 * MIN_SAMPLES:
        return []
    findings = []
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    intervals = np.diff(times)
    repeated = _repeated_share(steps == 0.0)
    if repeated >= REPEATED_SHARE:
        text = (
            f"{repeated:.0%} of the positions of {id} repeat the one before while it moves: is it "
            "sent more often than it is measured?"
        )
        findings.append(Finding("remark", "repeats", text))
    moved = (intervals > 0.0) & (steps > 0.0)
    if moved.sum() >= MIN_SAMPLES:
        speed = float(np.median(steps[moved] / intervals[moved]))
        if speed > MAX_SPEED:
            text = (
                f"{id} moves at {format_number(speed)} m/s: are the units of length and time right?"
            )
            findings.append(Finding("remark", "speed", text))
        findings += _check_sweep(id, times, points, unit)
    return findings


def _check_sweep(id: str, times: Array, points: Array, unit: str) -> list[Finding]:
    """Check that a hand is not too fast over too long a way, as in inches taken for metres.

    What sweeps steadily over metres at a speed that no hand keeps up is refused. Jumps back and
    forth are no sweep.
    """
    span = float(np.max(np.subtract(*np.percentile(points, [95.0, 5.0], axis=0))))
    interval = float(np.median(np.diff(times)))
    if not MAX_REACH < span <= MAX_EXTENT or not interval > 0.0:
        return []
    every = max(1, round(SWEEP_INTERVAL / interval))  # noise hides the sweep in shorter steps
    steps, intervals = np.diff(points[::every], axis=0), np.diff(times[::every])
    velocities = steps[intervals > 0.0] / intervals[intervals > 0.0, None]
    speeds = np.linalg.norm(velocities, axis=1)
    if not len(speeds) or (speed := float(np.percentile(speeds, 95.0))) <= MAX_REACH_SPEED:
        return []
    fast = speeds > FAST
    pairs = fast[1:] & fast[:-1]
    onwards = np.sum(velocities[1:] * velocities[:-1], axis=1)[pairs] > 0.0
    refused = span > WIDE and fast.mean() >= FAST_SHARE and len(onwards) >= MIN_SAMPLES
    refused = refused and bool(onwards.mean() >= STEADY_SHARE)
    reaches = {u: span / METRES[unit] * size for u, size in METRES.items() if u != unit}
    fits = [u for u, reach in reaches.items() if 0.02 <= reach <= MAX_REACH]
    fits.sort(key=lambda u: abs(math.log(reaches[u] / USUAL_EXTENT)))
    text = f"{id} moves over {format_number(span)} m at up to {format_number(speed)} m/s"
    text += question("are its positions in", fits)
    return [Finding("refuse" if refused else "remark", "speed", text, fix_by("length_unit", fits))]


def _repeated_share(repeats: NDArray[np.bool_]) -> float:
    """Return the share of repeated positions between moves; a rest is no repetition."""
    moves = np.flatnonzero(~repeats)
    between = np.diff(moves) - 1
    short = between[between <= MAX_REPEATS]
    if (short > 0).sum() < MIN_SAMPLES:
        return 0.0
    return float(short.sum() / (short.sum() + len(moves)))
