"""The grasp candidate of the target that the movement leads to, with opening and wrist.

Every object has a few ways to be grasped, found in its mesh or declared (:mod:`igrip.grasps`). The
posterior over targets is carried over to them: given a target, each of its candidates is weighed by
its prior, by how near the palm is expected to where that candidate has it, by the direction of the
movement, and by how the hand is turned where its source measures that.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.geometry.scene import Geometry, PlacedObject
from igrip.grasps.candidates import candidates_of
from igrip.grips import GRIPS, Grasp, Grip, GripConfig
from igrip.grips._choice import choose
from igrip.grips._placed_candidates import PackedCandidates, pack_candidates
from igrip.motion.palm_axes import PalmAxes
from igrip.motion.trajectory import Motion
from igrip.targets import TargetEstimate
from igrip.taxonomy import NAMES

Array = NDArray[np.float64]

UNKNOWN = PalmAxes((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class _Frame(NamedTuple):
    """Objects with their candidates and poses; kept while none of them changes."""

    objects: Sequence[PlacedObject]
    packed: PackedCandidates
    rotations: Array
    translations: Array
    present: NDArray[np.int64]  # the grips that any candidate has
    names: tuple[str, ...]


@GRIPS.register("candidates")
class CandidateGrip:
    """Selects the likeliest grasp candidate of the target.

    Parameters
    ----------
    config : GripConfig
        Weights of the evidence.
    """

    def __init__(self, config: GripConfig) -> None:
        self._weights = (config.heading_weight, config.pointing_weight, config.turn_weight)
        self._palm_std = config.palm_std
        self._frame: _Frame | None = None

    def select(self, estimate: TargetEstimate, geometry: Geometry, motion: Motion) -> Grip:
        """Return grip, probability of each grip, opening and wrist; none without a target.

        The grip, opening and wrist are those of the target; the probability of grips is averaged
        over the objects.
        """
        target = estimate.target
        if target is None:
            return Grip(None)
        frame = self._frame_of(geometry.objects)
        objects = estimate.probability
        if objects is None:
            objects = np.zeros(len(geometry.objects))
            objects[target] = 1.0
        reach, palm = motion.reach, motion.palm or UNKNOWN
        grips = np.zeros(len(NAMES))
        name, opening, wrist, wrist_std, x, y, z = choose(
            *frame.packed, frame.rotations, frame.translations, geometry.cylinders().rows, objects,
            target, geometry.objects[target].centre, reach.state, reach.now,
            reach.phase == "decelerating", reach.moving, *palm, self._palm_std, self._weights,
            grips,
        )  # fmt: skip
        if name < 0:  # no hand fits round it
            return Grip(None)
        probability = dict(zip(frame.names, grips[frame.present].tolist(), strict=True))
        return Grip(NAMES[name], probability, Grasp((x, y, z), opening, wrist, wrist_std))

    def _frame_of(self, objects: Sequence[PlacedObject]) -> _Frame:
        """Return the candidates and poses of these objects."""
        old = self._frame
        if old is not None and len(old.objects) == len(objects):
            if all(a is b for a, b in zip(old.objects, objects, strict=True)):
                return old
            if all(a.model is b.model for a, b in zip(old.objects, objects, strict=True)):
                rotations, translations = _poses(objects)
                self._frame = old._replace(
                    objects=list(objects), rotations=rotations, translations=translations
                )
                return self._frame
        packed = pack_candidates([candidates_of(o.model) for o in objects])
        present = np.unique(packed.grip)
        names = tuple(NAMES[grip] for grip in present)
        self._frame = _Frame(list(objects), packed, *_poses(objects), present, names)
        return self._frame


def _poses(objects: Sequence[PlacedObject]) -> tuple[Array, Array]:
    return np.array([o.rotation for o in objects]), np.array([o.translation for o in objects])
