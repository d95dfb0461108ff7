"""The candidates of a mesh, from its surface to a few ways to grasp it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from igrip.grasps.candidate import Candidate
from igrip.grasps.classify import classify
from igrip.grasps.clusters import Likeness, clusters
from igrip.grasps.hand_fit import BACK, HandFits, fit_hands
from igrip.grasps.opposition import find_oppositions
from igrip.grasps.parts import name_parts
from igrip.grasps.surface import sample_surface
from igrip.grasps.turns import Line, Turned, arc_of, lines_of, turn_to
from igrip.grasps.verify import HoldTest
from igrip.objects.model import ObjectModel
from igrip.taxonomy import GRIP_TYPES, NAMES

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

MAX_CANDIDATES = 12
MIN_WEIGHT = 0.002  # of all hands that fit; smaller groups are chance
MIN_OF_BEST = 0.25  # of the support of the best group of the same grip
MIN_SHARE = 0.02  # of the best hand's weight; worse ones only cost time
MIN_PRIOR = 0.02  # of a candidate, unless it is the best of its grip: handles are small
SAME_PLACE, SAME_ANGLE, SAME_OPENING = 0.08, np.cos(np.radians(30.0)), 0.02  # m, cosine, m


def build_candidates(model: ObjectModel) -> list[Candidate]:
    """Find how an object can be grasped, the likeliest way first."""
    surface = sample_surface(model.vertices, model.faces)
    fits = fit_hands(surface, find_oppositions(surface), model.axis)
    if not len(fits.opening):
        return []
    grips, weight = classify(fits, model)
    kept = np.flatnonzero(weight > MIN_SHARE * weight.max())
    fits = HandFits(*(column[kept] for column in fits))
    grips, weight = grips[kept], weight[kept] / weight[kept].sum()
    if model.symmetry == "box":
        fits, grips, weight = _with_half_turns(fits, grips, weight, model)
    lines = lines_of(surface, model)
    found: list[Candidate] = []
    for grip in np.unique(grips):
        own = np.flatnonzero(grips == grip)
        part = HandFits(*(column[own] for column in fits))
        found += _of_grip(NAMES[grip], part, weight[own], lines, model)
    test = HoldTest(model.vertices, model.faces, model.bvh)
    found = [candidate for candidate in found if test.holds(candidate)]
    return name_parts(_few(found), model)


def _few(found: list[Candidate]) -> list[Candidate]:
    """Return the candidates that are not much the same as a better one, with their priors.

    A hand may slide along an object, and the border between two grips is none in the object: what
    differs from a better candidate of the same family by that alone is left to it.
    """
    kept: list[Candidate] = []
    for one in sorted(found, key=lambda candidate: -candidate.weight):
        same = next((k for k, other in enumerate(kept) if _same(one, other)), None)
        if same is None:
            kept.append(one)
        else:
            kept[same] = kept[same]._replace(weight=kept[same].weight + one.weight)
    total = sum(one.weight for one in kept)
    grips: set[str] = set()
    few = []
    for one in sorted(kept, key=lambda candidate: -candidate.weight):
        if one.weight >= (MIN_PRIOR if one.grip in grips else MIN_WEIGHT) * total:
            few.append(one._replace(weight=one.weight / total))
        grips.add(one.grip)
    return few[:MAX_CANDIDATES]


def _same(a: Candidate, b: Candidate) -> bool:
    """Return whether two candidates of one family differ by a small step alone, turns allowed."""
    if GRIP_TYPES[a.grip].family != GRIP_TYPES[b.grip].family:
        return False
    a = a.turned(a.turn_towards(b))
    b = b.turned(b.turn_towards(a))
    return bool(
        np.linalg.norm(a.point - b.point) < SAME_PLACE
        and a.approach @ b.approach > SAME_ANGLE
        and abs(a.closing @ b.closing) > SAME_ANGLE
        and abs(a.opening - b.opening) < SAME_OPENING
    )


def _of_grip(
    grip: str, fits: HandFits, weight: Array, lines: list[Line], model: ObjectModel
) -> Iterator[Candidate]:
    """Yield the candidates of one grip: first those that may be turned, then the others."""
    free = np.ones(len(weight), dtype=bool)
    for k, line in enumerate(lines):
        rows = np.flatnonzero(free)
        turned = turn_to(line, HandFits(*(column[rows] for column in fits)))
        likeness = Likeness(turned.centre, turned.approach, turned.closing, fits.opening[rows])
        for middle, members, near in clusters(likeness, weight[rows], MIN_WEIGHT, MIN_OF_BEST):
            centre, half = arc_of(turned.turn[members], weight[rows[members]])
            if k == 0 and model.symmetry == "cylinder":
                centre, half = 0.0, np.pi
            if half <= 0.0:
                continue
            best = _nearest_turn(turned, weight[rows], members, centre, half, middle)
            turns = (-np.pi, np.pi)
            if half < np.pi:
                off = float(_wrapped(centre - turned.turn[best : best + 1])[0])
                turns = (off - half, off + half)
            total = float(weight[rows[near]].sum())
            yield _candidate(grip, fits, int(rows[best]), total, line, turns)
            free[rows[near]] = False
    rows = np.flatnonzero(free)
    if not len(rows):
        return
    likeness = Likeness(
        fits.centre[rows], fits.approach[rows], fits.closing[rows], fits.opening[rows]
    )
    for middle, _, near in clusters(likeness, weight[rows], MIN_WEIGHT, MIN_OF_BEST):
        total = float(weight[rows[near]].sum())
        yield _candidate(grip, fits, int(rows[middle]), total, lines[0], (0.0, 0.0))


def _nearest_turn(
    turned: Turned, weight: Array, members: Indices, centre: float, half: float, middle: int
) -> int:
    """Return the member that stands for a group: near the middle of its arc, and of weight."""
    if half >= np.pi:
        return middle
    off = _wrapped(turned.turn[members] - centre)
    return int(members[np.argmax(weight[members] * np.exp(-((off / np.radians(15.0)) ** 2)))])


def _candidate(
    grip: str, fits: HandFits, k: int, weight: float, line: Line, turns: tuple[float, float]
) -> Candidate:
    return Candidate(
        grip, "body", fits.centre[k], fits.approach[k], fits.closing[k], float(fits.opening[k]),
        float(fits.features[k, BACK]), weight, line.point, line.frame[:, 2], turns,
    )  # fmt: skip


def _with_half_turns(
    fits: HandFits, grips: Indices, weight: Array, model: ObjectModel
) -> tuple[HandFits, Indices, Array]:
    """Return the hands, and where half turns about the object's axes bring them."""
    rotation, origin = model.mesh_from_object[:3, :3], model.origin
    every = []
    for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)):
        turn = rotation @ np.diag(signs).astype(float) @ rotation.T
        every.append(fits._replace(
            centre=origin + (fits.centre - origin) @ turn.T,
            approach=fits.approach @ turn.T, closing=fits.closing @ turn.T,
        ))  # fmt: skip
    together = HandFits(*(np.concatenate(columns) for columns in zip(*every, strict=True)))
    return together, np.tile(grips, 4), np.tile(0.25 * weight, 4)


def _wrapped(angle: Array) -> Array:
    """Return angles between -π and π."""
    wrapped: Array = (angle + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped
