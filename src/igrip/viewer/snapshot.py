"""The state of the estimator at one time, as arrays to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject, Scene
from igrip.intention import Intention
from igrip.motion.trajectory import Motion

Array = NDArray[np.float64]
RAY_LENGTH = 0.25  # of a ray that meets nothing [m]


@dataclass(frozen=True)
class HandSnapshot:
    """One hand at one time."""

    intention: Intention  # its newest
    past: Array  # filtered positions in the window, newest last, shape (n, 3) [m]
    motion: Motion | None  # None while unknown
    target: PlacedObject | None  # the predicted one
    assisted: bool = False  # whether a device assists it


@dataclass(frozen=True)
class Snapshot:
    """All usable objects and tracked hands at one time."""

    t: float  # on the clock of the messages [s]
    objects: Sequence[PlacedObject]
    hands: Sequence[HandSnapshot]
    scene: Scene  # the geometry in which their rays were cast


def take_snapshot(estimator: Estimator) -> Snapshot:
    """Return the state after an ``update``, with the newest intention of each hand."""
    objects = estimator.objects
    by_id = {placed.id: placed for placed in objects}
    tracks = estimator.hands
    hands = []
    for id, intention in sorted(estimator.latest.items()):
        track = tracks[id]
        known = intention.status in ("idle", "reaching", "holding")
        target = by_id.get(intention.target) if intention.target else None
        motion = track.motion if known else None
        assisted = estimator.config.commitment.assists(id)
        hands.append(HandSnapshot(intention, track.trajectory.past, motion, target, assisted))
    return Snapshot(estimator.t, objects, hands, estimator.scene)


def rays_of(scene: Scene, hand: HandSnapshot) -> tuple[Array, Array]:
    """Return the rays towards the target as segments.

    Returns
    -------
    hits, misses : (n, 2, 3), (m, 2, 3)
        From each predicted point to the impact on the target, or over a fixed length where the ray
        misses it [m].
    """
    if hand.motion is None or hand.target is None:
        return np.empty((0, 2, 3)), np.empty((0, 2, 3))
    directions, lengths = scene.impacts(hand.motion, hand.target)
    norms = np.linalg.norm(directions, axis=2)
    meets = np.isfinite(lengths)
    reach = np.where(meets, lengths, RAY_LENGTH / norms)
    origins = np.broadcast_to(hand.motion.future[:, None, :], directions.shape)
    ends = origins + directions * reach[:, :, None]
    segments = np.stack([origins, ends], axis=2)
    drawn = np.isfinite(norms)
    return segments[drawn & meets], segments[drawn & ~meets]
