"""One recorded movement, as every importer returns it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from igrip.errors import DatasetError
from igrip.io.column_names import near_miss
from igrip.io.takes.take import Track

Array = NDArray[np.float64]
Pivot = Literal["middle", "mesh"]
NO_TARGET = "none"


@dataclass(frozen=True)
class MovingObject:
    """An object that was tracked.

    Attributes
    ----------
    track : Track
        Its poses in igrip's world; upright where it has no orientations.
    pivot : str
        What the track is of: ``middle``, the middle of the object's cylinder; or ``mesh``, the
        origin of its mesh.
    """

    track: Track
    pivot: Pivot = "middle"


@dataclass(frozen=True)
class RecordedReach:
    """One recorded movement of one hand towards one of several objects.

    Attributes
    ----------
    name : str
        Name of the recording.
    participant, trial, hand : str
        The person, the trial, and the hand that moved.
    target : str or None
        The id of the object it moved to, ``none`` for no reach; None: not known.
    times : (n,)
        Times of the samples [s], increasing; 0 at movement onset.
    positions : (n, 3)
        Positions of the hand [m].
    object_positions : mapping of str to (3,)
        Position of each object [m].
    extra : mapping of str to str
        Further columns of the table of trials.
    grip, movement : str or None
        Of the task.
    models : mapping of str to str
        Model of each object, where it is not that of the options.
    movement_only : bool
        Whether the samples hold the movement alone. If not, onset and end are left to the
        evaluation, and no rest is added before them.
    moving_objects : mapping of str to MovingObject
        Objects that were tracked, at the same times.
    other_hands : mapping of str to Track
        Further hands.
    onset_s, end_s : float or None
        Of the movement, where they are known [s].
    lost : (m,)
        When the hand was looked for and not seen [s].
    duration : float or None
        Length of the recording [s]; by default until the hand's last sample.
    remarks : sequence of str
        What was repaired or is odd.
    converted_from : mapping or None
        The frame and units that the numbers were converted from.

    Raises
    ------
    DatasetError
        If the times do not increase, a number is not finite, or the target has no position.
    """

    name: str
    participant: str
    trial: str
    hand: str
    target: str | None
    times: Array
    positions: Array
    object_positions: Mapping[str, Array]
    extra: Mapping[str, str] = field(default_factory=dict)
    grip: str | None = None
    movement: str | None = None
    models: Mapping[str, str] = field(default_factory=dict)
    movement_only: bool = True
    moving_objects: Mapping[str, MovingObject] = field(default_factory=dict)
    other_hands: Mapping[str, Track] = field(default_factory=dict)
    onset_s: float | None = None
    end_s: float | None = None
    lost: Array = field(default_factory=lambda: np.zeros(0))
    duration: float | None = None
    remarks: Sequence[str] = ()
    converted_from: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        finite = len(self.times) > 1 and np.isfinite(self.times).all()
        if not finite or not (np.diff(self.times) > 0).all():
            raise DatasetError(f"{self.name}: its times do not increase, or are fewer than two")
        if not np.isfinite(self.positions).all():
            raise DatasetError(f"{self.name}: has positions that are not finite")
        if not all(np.isfinite(position).all() for position in self.object_positions.values()):
            raise DatasetError(f"{self.name}: an object's position is not finite")
        objects = [*self.object_positions, *self.moving_objects]
        if self.target not in (None, NO_TARGET) and self.target not in objects:
            raise DatasetError(
                f"{self.name}: its target {self.target!r} has no position"
                f"{near_miss(str(self.target), objects)}; there are {', '.join(objects) or 'none'}"
            )

    @property
    def seconds(self) -> float:
        """Length of the recording [s]."""
        return float(self.times[-1]) if self.duration is None else self.duration
