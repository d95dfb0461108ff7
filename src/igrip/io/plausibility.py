"""A plausibility check on first contact: whether numbers mean what they are taken for.

Data in millimetres, in milliseconds or in a world with y up are well-formed, and wrong. The check
names the unit or frame that would fit. The limits are wide: reaches span centimetres to metres at
0.1 to 10 m/s, and motion is sampled at 1 to 5,000 Hz.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from igrip.io.findings import Array, Finding, Samples, options_that_fix, refusal
from igrip.io.fitting_units import fitting_units, fix_by, format_number, question
from igrip.io.frames import METRES, SECONDS
from igrip.io.plausible_motion import MAX_EXTENT, USUAL_EXTENT, check_motion
from igrip.io.upright import layer_of

__all__ = ["Finding", "Samples", "check_extents", "check_length", "check_samples", "check_sizes",
           "check_times", "check_up", "options_that_fix", "refusal"]  # fmt: skip

MAX_INTERVAL = 2.0  # s between samples; more is refused
SLOW_INTERVAL = 0.5  # s; more is remarked
MIN_INTERVAL = 2e-4  # s; less is refused
MIN_EXTENT = 0.005  # m that the whole scene must span
USUAL_INTERVAL, USUAL_SIZE = 0.012, 0.15  # s, m: which unit fits best
SIZES = (0.002, 2.0)  # m of an object that a hand grasps
MAX_MESSAGES = 100_000  # that any recording may be resampled to; a longer one: 20 a sample
MESSAGES_PER_SAMPLE = 20
MIN_SAMPLES = 5  # fewer show nothing
ALIGNED = math.cos(math.radians(10.0))


@np.errstate(over="ignore", invalid="ignore")  # whatever the numbers are, they are judged
def check_samples(
    hands: Mapping[str, Samples],
    objects: Mapping[str, Samples],
    length_unit: str = "m",
    time_unit: str = "s",
    times: Array | None = None,
) -> list[Finding]:
    """Check a scene, in units converted from those given; ``times`` (n,) [s]: of its messages."""
    scene = [*hands.items(), *objects.items()]
    if times is None:
        times = max((s.times for _, s in scene), key=len, default=np.empty(0))
    findings = check_times(times, time_unit)
    findings += check_extents({id: s.positions for id, s in scene}, length_unit)
    for id, samples in hands.items():
        findings += check_motion(id, samples, length_unit)
    up = check_up(
        {id: s.orientations for id, s in objects.items() if s.orientations is not None},
        {id: s.positions for id, s in objects.items()},
    )
    return findings + (up or _check_layer(hands, objects))


def _check_layer(hands: Mapping[str, Samples], objects: Mapping[str, Samples]) -> list[Finding]:
    """Remark on a scene that lies in a layer along another axis than z."""
    places = [np.median(r, axis=0) for s in objects.values() if len(r := _finite_rows(s.positions))]
    for samples in hands.values():
        found = layer_of(_finite_rows(samples.positions), places)
        if found is not None:
            text = f'{found.text}: if {found.axis} points up, declare up = "{found.axis}"'
            return [Finding("remark", "up", text, ("up", found.axis))]
    return []


def check_times(times: ArrayLike, unit: str = "s") -> list[Finding]:
    """Check the interval between samples at times (n,) that were converted from ``unit`` [s]."""
    values = np.asarray(times, dtype=np.float64)
    steps = np.diff(values[np.isfinite(values)])
    steps = steps[steps > 0.0]
    if len(steps) < MIN_SAMPLES - 1:
        return []
    step = float(np.median(steps))
    if MIN_INTERVAL <= step <= SLOW_INTERVAL:
        return []
    fits = fitting_units(step, unit, SECONDS, (5e-4, 0.25), USUAL_INTERVAL)
    counted = step == 1.0 and len(steps) > 2 * MIN_SAMPLES and bool((steps % 1.0 == 0.0).all())
    refused = counted or not MIN_INTERVAL <= step <= MAX_INTERVAL
    named = [*fits, "frame numbers (an import takes their rate)"] if counted else fits
    text = f"steps of {format_number(step)} s" + question("are these", named)
    if not fits and step > SLOW_INTERVAL:
        text += ": igrip follows motion from about 10 samples a second on"
    verdict: Literal["refuse", "remark"] = "refuse" if refused else "remark"
    return [Finding(verdict, "interval", text, fix_by("time_unit", fits))]


def check_length(times: ArrayLike, rate: float) -> list[Finding]:
    """Check how many messages times (n,) [s] give at a rate [Hz], before any is made."""
    values = np.asarray(times, dtype=np.float64)
    values = values[np.isfinite(values)]
    if not len(values):
        return []
    seconds = float(values.max() - values.min())
    messages = seconds * rate
    if messages <= max(MAX_MESSAGES, MESSAGES_PER_SAMPLE * len(values)):
        return []
    text = (
        f"{len(values)} samples over {format_number(seconds)} s would become {messages:.3g} "
        f"messages at {rate:g} Hz: is the unit of time right, and are there odd times?"
    )
    return [Finding("refuse", "length", text)]


def check_extents(positions: Mapping[str, ArrayLike], unit: str = "m") -> list[Finding]:
    """Check how far bodies move and are apart, by id (n, 3) [m], converted from ``unit``."""
    findings: list[Finding] = []
    everything = []
    for id, given in positions.items():
        points = _finite_rows(given)
        if len(points) < MIN_SAMPLES:
            continue
        everything.append(points)
        # the bulk of it: a few stray points are no matter of the unit
        low, high = np.percentile(points, [5.0, 95.0], axis=0)
        span = float(np.max(high - low))
        away = float(np.median(np.abs(points).max(axis=1)))
        size, words = (span, "moves over") if span > MAX_EXTENT else (away, "is")
        if size <= MAX_EXTENT * (1.0 if size is span else 5.0):
            continue
        fits = fitting_units(size, unit, METRES, (0.02, 5.0), USUAL_EXTENT)
        text = f"{id} {words} {format_number(size)} m{'' if size is span else ' from the origin'}"
        text += question("are its positions in", fits)
        findings.append(Finding("refuse", "extent", text, fix_by("length_unit", fits)))
    if findings or not everything:
        return findings
    span = float(np.max(np.ptp(np.concatenate(everything), axis=0)))
    if len(everything) > 1 and 0.0 < span < MIN_EXTENT:
        fits = fitting_units(span, unit, METRES, (0.05, 10.0), USUAL_EXTENT)
        text = f"the whole scene spans {format_number(span)} m" + question("are positions in", fits)
        findings.append(Finding("refuse", "extent", text, fix_by("length_unit", fits)))
    return findings


def check_sizes(extents: Mapping[str, ArrayLike], unit: str = "m") -> list[Finding]:
    """Check the extents (3,) of meshes by name [m], converted from ``unit``."""
    findings = []
    for name, extent in extents.items():
        size = float(np.max(np.asarray(extent, dtype=np.float64)))
        if SIZES[0] <= size <= SIZES[1]:
            continue
        fits = fitting_units(size, unit, METRES, (0.02, 0.5), USUAL_SIZE)
        text = f"{name} is {format_number(size)} m long" + question("is it in", fits)
        findings.append(Finding("refuse", "size", text, fix_by("length_unit", fits)))
    return findings


def check_up(
    orientations: Mapping[str, ArrayLike], positions: Mapping[str, ArrayLike]
) -> list[Finding]:
    """Check that objects do not all hang upside down or lie: then z is hardly up.

    Parameters
    ----------
    orientations : mapping of str to (n, 4)
        World from mesh, x, y, z, w, by object.
    positions : mapping of str to (n, 3)
        By object [m]. Where nothing turns, they can show which axis is up.
    """
    axes = [axis for q in orientations.values() if (axis := _upright_axis(q)) is not None]
    if axes:
        up = np.array(axes)
        if (up[:, 2] < -ALIGNED).all():
            text = "every object hangs upside down: does z point down (up = -z)?"
            return [Finding("remark", "up", text, ("up", "-z"))]
        for column, name in ((1, "y"), (0, "x")):
            for sign, word in ((1.0, name), (-1.0, f"-{name}")):
                if (sign * up[:, column] > ALIGNED).all():
                    text = f"every object lies, with its top along {word}: is up = {word}?"
                    return [Finding("remark", "up", text, ("up", word))]
    places = [np.median(rows, axis=0) for p in positions.values() if len(rows := _finite_rows(p))]
    if len(places) > 1 and not (axes and (np.array(axes)[:, 2] > ALIGNED).any()):
        spread = np.ptp(np.array(places), axis=0)
        if spread[1] < 0.01 and spread[2] > 0.05 and spread[0] > 0.01:
            text = "all objects are at one y and at different z: is y up (up = y)?"
            return [Finding("remark", "up", text, ("up", "y"))]
    return []


def _upright_axis(quaternions: ArrayLike) -> Array | None:
    """Return where the z axis of a mesh points, the mean over (n, 4) x, y, z, w; None: unknown."""
    q = np.asarray(quaternions, dtype=np.float64).reshape(-1, 4)
    norm = np.linalg.norm(q, axis=1, keepdims=True)
    q = (q / np.where(norm > 0.0, norm, np.nan))[np.isfinite(norm[:, 0]) & (norm[:, 0] > 0.0)]
    if not len(q):
        return None
    x, y, z, w = q.T
    mean: Array = np.array(
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    ).mean(1)
    return mean / max(float(np.linalg.norm(mean)), 1e-12)


def _finite_rows(positions: ArrayLike) -> Array:
    rows = np.asarray(positions, dtype=np.float64).reshape(-1, 3)
    return rows[np.isfinite(rows).all(axis=1)]
