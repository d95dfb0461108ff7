"""Which piece belongs to which arm, from frame to frame; and which pieces are no arms at all."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from igrip.perception.arms.blobs import Blob, join
from igrip.perception.arms.end_shape import LENGTH
from igrip.perception.arms.palm import ArmEnd, arm_end
from igrip.rgbd import Array

GATE = 0.12  # a piece so near to where a hand should be may be its [m]; guess
MIN_LENGTH = 0.12  # of an arm over the table [m]; guess
LONG = 0.30  # an arm that was there from the beginning is so long [m]; guess
LOW = 0.25  # and nowhere higher over the table [m]; guess
LONG_SLENDER = 3.0  # and so many times as long as broad; guess
SLENDER = 1.7  # times as long as broad, an arm is at least; guess
LONG_HAND = (
    0.18  # what hangs in the air with no edge near is a hand with some of its arm [m]; guess
)
HOVERS = 0.03  # what is nowhere lower than that stands on nothing [m]; guess
LEANS = np.radians([12.0, 60.0])  # over the table: what stands is steeper, what lies less; guess
NEAR_HAND = 0.12  # from a known hand: what moves there is what the hand moves [m]; guess
STEP = 0.01  # a hand that moved so far has moved [m]; guess
COAST = 0.1  # s for which a hand that is not measured goes on as before
HELD = 0.4  # s for which an arm that is not measured is remembered
SAME = 0.06  # arms nearer than that at both ends are one [m]; guess
MAX_SPEED = 3.0  # of a hand [m/s]


@dataclass(eq=False)
class Arm:
    """An arm that is followed, in the frame of the table [m]."""

    entry: Array  # (3,)
    end: ArmEnd
    t: float  # s, when it was last measured
    blob: Blob
    still_since: float  # s
    still_at: Array  # (3, 3): palm, tip and middle at that time
    moved: bool = False
    hits: int = 1
    velocity: Array = field(default_factory=lambda: np.zeros(3))

    def predict(self, t: float) -> Array:
        """Return where its palm should be at a time [s]."""
        ahead: Array = self.end.palm + self.velocity * min(max(t - self.t, 0.0), COAST)
        return ahead


class ArmTracker:
    """Follows the arms before one camera; ``forget_after`` is in seconds."""

    def __init__(self, forget_after: float, still: float) -> None:
        self._forget_after, self._still = forget_after, still
        self.arms: list[Arm] = []

    def update(self, t: float, blobs: list[Blob], camera: Array, outside: Array) -> list[Arm]:
        """Return the arms that are measured in a frame of time ``t`` [s].

        ``camera`` (3,) is where it is, ``outside`` (3,) a place beyond the edge where people are.
        """
        self.arms = [arm for arm in self.arms if t - arm.t <= HELD]
        parts: dict[int, list[Blob]] = {}
        free: list[Blob] = []
        for blob in blobs:
            owners = [k for k, arm in enumerate(self.arms) if _touches(blob, arm, t)]
            if not owners:
                free.append(blob)
            for k, part in zip(owners, _shared(blob, [self.arms[k] for k in owners], t),
                               strict=True):  # fmt: skip
                if len(part.points) >= 25:
                    parts.setdefault(k, []).append(part)
        for k, own in parts.items():
            self._follow(self.arms[k], t, join(own), camera)
        self._drop_doubles()
        for blob in free:
            arm = self._new(t, blob, camera, outside)
            if arm is not None:
                self.arms.append(arm)
        return [arm for arm in self.arms if arm.t == t]

    def at_rest(self, arm: Arm, t: float) -> bool:
        """Whether an arm has not moved for so long that it is a thing."""
        patience = self._forget_after if arm.moved else self._still
        return t - arm.still_since > patience

    def _follow(self, arm: Arm, t: float, blob: Blob, camera: Array) -> None:
        if blob.entry is not None:
            arm.entry = blob.entry
        elif arm.blob.entry is None:  # it hangs in the air: its far end goes along
            arm.entry = arm.entry + arm.velocity * (t - arm.t)
        end = arm_end(blob.points, arm.entry, camera)
        if end is None:
            return
        dt = max(t - arm.t, 1e-3)
        velocity = (end.palm - arm.end.palm) / dt
        speed = float(np.linalg.norm(velocity))
        velocity *= min(1.0, MAX_SPEED / max(speed, 1e-9))
        arm.velocity = 0.5 * (arm.velocity + velocity)
        arm.end, arm.t, arm.blob, arm.hits = end, t, blob, arm.hits + 1
        middle = blob.points.mean(axis=0)
        gaps = np.stack([end.palm, end.tip, middle]) - arm.still_at
        if np.linalg.norm(gaps, axis=1).min() > STEP:  # noise moves one or the other
            arm.still_at = np.stack([end.palm, end.tip, middle])
            arm.still_since, arm.moved = t, True

    def _new(self, t: float, blob: Blob, camera: Array, outside: Array) -> Arm | None:
        entry = blob.entry
        if entry is None:
            entry = _far_end(blob.points, outside)
        end = arm_end(blob.points, entry, camera)
        if end is None:
            return None
        length = float(np.linalg.norm(end.tip - entry))
        beside = any(_gap(blob, arm.end) < NEAR_HAND for arm in self.arms if arm.moved)
        if blob.entry is None:
            good = (
                blob.appeared and not beside and length >= LONG_HAND and _is_airborne(blob, length)
            )
        elif blob.appeared and not beside:
            good = length >= MIN_LENGTH
        else:
            good = not beside and _is_long(blob)
        if not good:
            return None
        still = np.stack([end.palm, end.tip, blob.points.mean(axis=0)])
        return Arm(entry, end, t, blob, t, still)

    def _drop_doubles(self) -> None:
        kept: list[Arm] = []
        for arm in sorted(self.arms, key=lambda arm: -arm.hits):
            if not any(
                np.linalg.norm(arm.entry - other.entry) < SAME
                and np.linalg.norm(arm.end.palm - other.end.palm) < SAME
                for other in kept
            ):
                kept.append(arm)
        self.arms = [arm for arm in self.arms if arm in kept]


def _gap(blob: Blob, end: ArmEnd) -> float:
    return float(np.linalg.norm(blob.points - end.palm, axis=1).min())


def _touches(blob: Blob, arm: Arm, t: float) -> bool:
    gaps = np.linalg.norm(blob.points - arm.predict(t), axis=1)
    return bool(gaps.min() < GATE)


def _shared(blob: Blob, arms: list[Arm], t: float) -> list[Blob]:
    """Return what of a piece is each arm's: what is nearest to where the arm should be."""
    if len(arms) < 2:
        return [blob] * len(arms)
    gaps = np.stack([
        _to_segment(blob.points, arm.entry, arm.predict(t) + 0.5 * LENGTH * arm.end.along)
        for arm in arms
    ])  # fmt: skip
    nearest = gaps.argmin(axis=0)
    return [
        Blob(
            blob.pixels[nearest == k], blob.points[nearest == k],
            None if blob.entry is None else arm.entry, blob.appeared,
        )
        for k, arm in enumerate(arms)
    ]  # fmt: skip


def _to_segment(points: Array, a: Array, b: Array) -> Array:
    """Return the distance of points (n, 3) from a segment."""
    way = b - a
    share = np.clip((points - a) @ way / max(float(way @ way), 1e-9), 0.0, 1.0)
    gaps: Array = np.linalg.norm(points - a - share[:, None] * way, axis=1)
    return gaps


def _axes(points: Array) -> tuple[Array, Array]:
    """Return the standard deviations along the principal axes (3,), and the axes as rows."""
    centred = points - points.mean(axis=0)
    values, vectors = np.linalg.eigh(centred.T @ centred / len(points))
    return np.sqrt(np.maximum(values[::-1], 0.0)), vectors[:, ::-1].T


def _is_slender(blob: Blob, length: float) -> bool:
    spread, _ = _axes(blob.points)
    # a uniform strip of breadth b has a standard deviation of b / sqrt(12)
    return bool(length > SLENDER * np.sqrt(12.0) * spread[1])


def _is_long(blob: Blob) -> bool:
    """Whether a piece lies along the table, as long and slender as an arm."""
    flat = blob.points * [1.0, 1.0, 0.0]
    spread, axes = _axes(flat)
    length = float(np.ptp(np.percentile(flat @ axes[0], [1.0, 99.0])))
    if np.percentile(blob.points[:, 2], 95.0) > LOW:
        return False
    return bool(length >= LONG and length > LONG_SLENDER * np.sqrt(12.0) * spread[1])


def _is_airborne(blob: Blob, length: float) -> bool:
    """Whether a piece that touches no edge stands on nothing and is as slender as an arm."""
    if not _is_slender(blob, length):
        return False
    if np.percentile(blob.points[:, 2], 5.0) > HOVERS:
        return True
    _, axes = _axes(blob.points)
    lean = np.arcsin(min(1.0, abs(float(axes[0, 2]))))
    return bool(LEANS[0] < lean < LEANS[1])


def _far_end(points: Array, outside: Array) -> Array:
    """Return the end of a piece on the side that people are on."""
    _, axes = _axes(points)
    along = (points - points.mean(axis=0)) @ axes[0]
    low, high = np.percentile(along, [3.0, 97.0])
    ends = [np.median(points[along <= low], axis=0), np.median(points[along >= high], axis=0)]
    gaps = [float(np.linalg.norm((end - outside)[:2])) for end in ends]
    far: Array = ends[int(np.argmin(gaps))]
    return far
