"""From recordings to moments, the frames of moving hands, by the same stages as in use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

import igrip
from igrip.config import Config
from igrip.geometry.scene import Geometry, Scene
from igrip.motion.trajectory import Motion
from igrip.objects.catalog import Catalog
from igrip.observation import Observation
from igrip.targets.learned.features import LOCAL, SHARED, features_of
from igrip.tracking import Tracker

Array = NDArray[np.float64]
SHAPES = (
    "cylinder:0.02x0.12", "cylinder:0.033x0.1", "cylinder:0.04x0.2", "cylinder:0.05x0.08",
    "cylinder:0.03x0.25", "cylinder:0.06x0.15", "box:0.06x0.06x0.06", "box:0.05x0.09x0.17",
    "box:0.04x0.08x0.24", "box:0.1x0.14x0.05", "box:0.07x0.16x0.19",
)  # fmt: skip
# none of the paper's four: the simulated cohort is to judge, not to teach
MESHES = (
    "002_master_chef_can", "004_sugar_box", "007_tuna_fish_can", "008_pudding_box",
    "010_potted_meat_can", "013_apple", "017_orange", "019_pitcher_base", "022_windex_bottle",
    "025_mug", "036_wood_block", "056_tennis_ball", "065-a_cups", "077_rubiks_cube",
)  # fmt: skip
THINGS = SHAPES + MESHES
ABSENT = 0.2  # weight of reaches for undetected objects: rarer in life than in training (guess)


@dataclass(frozen=True)
class Recording:
    """One recorded movement, or minute without one.

    Attributes
    ----------
    person, kind : str
        Who, and what they did.
    messages : sequence of Observation
        What a source would send.
    hand : str
        The hand that is followed.
    target : str or None
        What it reaches for.
    onset, end, back : float
        Of the movement, and when the hand leaves the object again [s].
    rate : float
        Messages a second.
    weight : float
        Of its moments.
    grip : str or None
        With which it is grasped.
    absent : bool
        Whether the target is never detected.
    """

    person: str
    kind: str
    messages: Sequence[Observation]
    hand: str
    target: str | None
    onset: float
    end: float
    back: float
    rate: float
    weight: float = 1.0
    grip: str | None = None
    absent: bool = False

    def with_absent_target(self) -> Recording:
        """Return the same without the target's poses: a reach for none of the objects."""
        less = self.without([str(self.target)])
        return replace(less, absent=True, weight=ABSENT * self.weight)

    def without(self, ids: Sequence[str]) -> Recording:
        """Return the same without the poses of some objects."""
        messages = [
            Observation(
                t=m.t, hands=dict(m.hands),
                objects={id: pose for id, pose in m.objects.items() if id not in ids},
            )
            for m in self.messages
        ]  # fmt: skip
        return replace(self, messages=messages)


@dataclass(frozen=True)
class Moments:
    """Frames in which a hand moves, one recording after the other; rows are frame × object.

    Attributes
    ----------
    local : (r, l), frame : (r,)
        Features of each object in each frame, and which frame it is.
    shared : (n, s)
        Features of the movement in each frame.
    target : (n,)
        Row of the object that is reached for; -1 for none.
    weight : (n,)
        Of each frame.
    trial : (n,)
        Number of the recording of each frame.
    part : (n,)
        Of the movement that is over, from 0 at onset to 1 at its end.
    """

    local: Array
    frame: NDArray[np.int64]
    shared: Array
    target: NDArray[np.int64]
    weight: Array
    trial: NDArray[np.int64]
    part: Array


@cache
def catalog() -> Catalog:
    """Return everything that is reached for in training."""
    return igrip.load_objects("ycb", *SHAPES)


Frames = Sequence[tuple[Motion, Geometry]]


def follow(recording: Recording) -> Frames:
    """Return motion and geometry of the hand in each frame, as the estimator has them."""
    config = Config()
    tracker = Tracker(catalog(), config.tracking, config.motion, config.objects, config.gating)
    scene = Scene(config.rays.model_copy(update={"rays_per_cone": 1}))  # they are not used
    frames = []
    for message in recording.messages:
        for hand in tracker.update(message):
            if hand.id == recording.hand and hand.motion and hand.is_followed:
                frames.append(
                    (hand.motion, scene.measure([hand.motion], tracker.placed_objects())[0])
                )
    return frames


def moments_of(recording: Recording, frames: Frames) -> Moments:
    """Return the features of one recording, rounded so that no machine's last digit matters."""
    local, shared, target, part, rows = [], [], [], [], [0]
    for motion, geometry in frames:
        if not motion.reach.may_move or not geometry.objects:
            continue
        each, common = features_of(motion.reach, geometry.cylinders())
        part.append((motion.t - recording.onset) / (recording.end - recording.onset))
        wanted = recording.onset <= motion.t < recording.back
        ids = [placed.id for placed in geometry.objects]
        found = wanted and recording.target in ids
        target.append(rows[-1] + ids.index(str(recording.target)) if found else -1)
        rows.append(rows[-1] + len(ids))
        local.append(each)
        shared.append(common)
    counts = np.diff(rows)
    weight = recording.weight * 30.0 / recording.rate
    apart: Array = np.concatenate([np.empty((0, len(LOCAL))), *local])
    together: Array = np.array(shared, dtype=np.float64).reshape(-1, len(SHARED))
    return Moments(
        apart.round(6),
        np.repeat(np.arange(len(counts)), counts),
        together.round(6),
        np.array(target, dtype=np.int64),
        np.full(len(counts), weight),
        np.zeros(len(counts), dtype=np.int64),
        np.array(part),
    )


def joined(parts: Sequence[Moments]) -> Moments:
    """Return moments of several recordings as one."""
    rows = np.cumsum([0] + [len(p.local) for p in parts[:-1]])
    frames = np.cumsum([0] + [len(p.target) for p in parts[:-1]])
    trials = np.cumsum([0] + [p.trial.max(initial=0) + 1 for p in parts[:-1]])
    return Moments(
        np.concatenate([p.local for p in parts]),
        np.concatenate([p.frame + f for p, f in zip(parts, frames, strict=True)]),
        np.concatenate([p.shared for p in parts]),
        np.concatenate(
            [np.where(p.target < 0, -1, p.target + r) for p, r in zip(parts, rows, strict=True)]
        ),
        np.concatenate([p.weight for p in parts]),
        np.concatenate([p.trial + t for p, t in zip(parts, trials, strict=True)]),
        np.concatenate([p.part for p in parts]),
    )


def thinned(moments: Moments, seed: int) -> Moments:
    """Keep half of the moments at 30 a second, fewer of faster ones, with the weight of the rest.

    Neighbours in time are alike.
    """
    random = np.random.default_rng(seed)
    chance = 0.5 * np.minimum(1.0, moments.weight)  # 30 / rate, times the recording's
    weighted = replace(moments, weight=moments.weight / chance)
    return selected(weighted, random.random(len(chance)) < chance)


def selected(moments: Moments, keep: NDArray[np.bool_]) -> Moments:
    """Return the frames for which ``keep``, shape (n,), is true."""
    rows = keep[moments.frame]
    frame, row = np.cumsum(keep) - 1, np.cumsum(rows) - 1
    target = moments.target[keep]
    return Moments(
        moments.local[rows], frame[moments.frame[rows]], moments.shared[keep],
        np.where(target < 0, -1, row[target]), moments.weight[keep], moments.trial[keep],
        moments.part[keep],
    )  # fmt: skip
