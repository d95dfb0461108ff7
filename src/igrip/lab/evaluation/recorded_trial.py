"""What a recording holds of one trial, gathered message by message."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from igrip.geometry.scene import PlacedObject
from igrip.io.datasets.dataset import Trial
from igrip.lab.evaluation.movement import movement_bounds, smooth_speeds
from igrip.lab.evaluation.trials import MAX_MISSED
from igrip.observation import Observation

Bounds = tuple[float, float]
"""Onset and end of a movement [s]."""
SLACK = 0.1  # a recording may end this much before the movement [s]
SILENCE = 0.3  # shorter gaps between the looks for a target are never silence [s]


@dataclass
class RecordedTrial:
    """The detections of the hand and the target of one trial."""

    trial: Trial  # its row of the table
    times: list[float] = field(default_factory=list)  # of each message [s]
    hand_detected: list[bool] = field(default_factory=list)  # in each message
    looked: list[float] = field(default_factory=list)  # when the target was looked for [s]
    target_detected: list[bool] = field(default_factory=list)  # each time
    hand_times: list[float] = field(default_factory=list)  # of raw measurements [s]
    hand_positions: list[tuple[float, float, float]] = field(default_factory=list)  # [m]
    objects: set[str] = field(default_factory=set)  # ids of all that were ever detected
    target_poses: list[tuple[float, PlacedObject]] = field(default_factory=list)
    """The target from when on [s], wherever it was placed anew."""
    observed: int = 0  # messages with the hand, and the target if looked for

    def add(self, observation: Observation) -> None:
        """Append one message."""
        id, target = self.trial.hand, self.trial.target
        hand = observation.hands.get(id) if id else None
        self.times.append(observation.t)
        self.hand_detected.append(hand is not None)
        if hand is not None:
            t = observation.t if hand.t is None else hand.t
            if not self.hand_times or t > self.hand_times[-1]:
                self.hand_times.append(t)
                self.hand_positions.append(hand.position)
        complete = hand is not None
        if target is not None and target in observation.objects:
            self.looked.append(observation.t)
            self.target_detected.append(observation.objects[target] is not None)
            complete &= self.target_detected[-1]
        self.observed += complete
        self.objects |= {id for id, pose in observation.objects.items() if pose is not None}

    def place_target(self, t: float, objects: Iterable[PlacedObject]) -> None:
        """Note where the target is among the objects that can be used at a time [s]."""
        placed = next((one for one in objects if one.id == self.trial.target), None)
        if placed is None:
            return
        if self.target_poses:
            before = self.target_poses[-1][1]
            same = np.array_equal(placed.translation, before.translation)
            if same and np.array_equal(placed.rotation, before.rotation):
                return
        self.target_poses.append((t, placed))

    @property
    def seconds(self) -> float:
        """Length of the recording [s]."""
        return self.times[-1] - self.times[0] if self.times else 0.0

    def bounds(self) -> Bounds | None:
        """Return onset and end: those of the table, or else those of the filtered raw trace [s]."""
        if self.trial.onset_s is not None and self.trial.end_s is not None:
            return self.trial.onset_s, self.trial.end_s
        speeds = smooth_speeds(np.array(self.hand_times), np.array(self.hand_positions))
        return movement_bounds(*speeds, noisy=True)

    def target_looks(self, begin: float, end: float) -> tuple[list[float], list[bool]]:
        """Return when the target was looked for, and detected; a silent source counts as misses.

        A target that was reported just once (a static object) needs no second look.
        """
        if self.target_detected == [True]:
            return [begin, *self.times[1:3]], [True] * 3
        steps = np.diff(self.looked)
        steps = steps[steps > 0.0]
        if not len(steps):
            return self.looked, self.target_detected
        usual = float(np.median(steps))
        times, detected = [], []
        for t, is_detected, after in zip(
            self.looked, self.target_detected, [*self.looked[1:], end], strict=True
        ):
            silent = 0
            if after - t > max(SILENCE, 3.0 * usual):
                silent = min(int((after - t) / usual - 1e-6), MAX_MISSED + 1)
            times += [t, *(t + usual * (k + 1) for k in range(silent))]
            detected += [is_detected, *[False] * silent]
        return times, detected

    def missing_part(self, bounds: Bounds) -> str | None:
        """Return which part of the movement the recording does not hold; None: it holds all."""
        if not self.times or self.times[-1] < bounds[1] - SLACK:
            return "the recording ends before the movement does"
        return "the recording begins after the movement does" if self.times[0] > bounds[0] else None
