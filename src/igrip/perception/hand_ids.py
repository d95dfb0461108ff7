"""Which hand is which: by how hands move, not by the detector's handedness.

A detector's handedness flips and repeats from one picture to the next. Here a hand keeps its id for
as long as its movement can be followed; labels count only when it is new.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from igrip.rgbd import Array
from igrip.settings import Settings, quantity

IDS = ("right", "left")
NO_MATCH = 1e3  # m


class HandIdConfig(Settings):
    """How hands may move, and when they are new or lost."""

    max_hands: int = quantity(2, "1", "hands that have ids", "two hands of one person", ge=1, le=4)
    max_speed: float = quantity(
        4.0, "m/s", "of a hand; reaches peak at 1 to 2, blows at 6 to 10", "guess", gt=0
    )
    noise: float = quantity(0.05, "m", "by which a hand may seem to jump", "guess", ge=0)
    max_gate: float = quantity(
        0.5, "m", "within which a hand is looked for, however long it was lost", "guess", gt=0
    )
    min_hits: int = quantity(3, "1", "frames running that make a new hand", "guess", ge=1)
    max_age: float = quantity(
        1.0, "s", "since it was last detected, after which a hand loses its id", "guess", gt=0
    )
    duplicate: float = quantity(
        0.04, "m", "within which a detection repeats a known hand", "guess", ge=0
    )
    coasting: float = quantity(
        0.15, "s", "time constant with which an undetected hand is taken to stop", "guess", gt=0
    )


class PalmMeasurement(NamedTuple):
    """One detected hand."""

    position: Array  # (3,), of its palm, in a frame that stands still [m]
    label: str | None = None  # left or right, the detector's guess
    score: float = 1.0  # how much the label counts


@dataclass
class _Track:
    position: Array
    t: float
    velocity: Array = field(default_factory=lambda: np.zeros(3))
    hits: int = 1
    votes: dict[str, float] = field(default_factory=dict)
    id: str | None = None

    def predict(self, t: float, config: HandIdConfig) -> Array:
        """Return where the hand may be [m]: it goes on, and comes to rest."""
        stopping = config.coasting * -np.expm1((self.t - t) / config.coasting)
        ahead: Array = self.position + self.velocity * stopping
        return ahead

    def update(self, t: float, palm: PalmMeasurement, config: HandIdConfig) -> None:
        dt = max(t - self.t, 1e-3)  # s
        velocity = (palm.position - self.position) / dt
        speed = float(np.linalg.norm(velocity))
        if speed > config.max_speed:
            velocity *= config.max_speed / speed
        # half a weight on the newest: noise of 5 mm would else be 0.2 m/s
        self.velocity = velocity if self.hits == 1 else 0.5 * (self.velocity + velocity)
        self.position, self.t, self.hits = palm.position, t, self.hits + 1

    def vote(self, palm: PalmMeasurement) -> None:
        if palm.label is not None:
            self.votes[palm.label] = self.votes.get(palm.label, 0.0) + palm.score


class HandIdTracker:
    """Gives hands their ids: ``right`` and ``left``, then ``hand3`` and ``hand4``."""

    def __init__(self, config: HandIdConfig | None = None) -> None:
        self._config = config or HandIdConfig()
        self._tracks: list[_Track] = []
        self._t = -np.inf

    def update(self, t: float, palms: Sequence[PalmMeasurement]) -> Mapping[str, int | None]:
        """Add the hands of a frame of time ``t`` [s], in any order, and return which is which.

        By id: the index of its palm; None: the hand is known and was not detected. A hand that is
        too new has no id yet. Where time goes back, everything is forgotten.
        """
        config = self._config
        if t < self._t:
            self._tracks = []
        self._t = t
        self._tracks = [track for track in self._tracks if t - track.t <= config.max_age]
        known = [track for track in self._tracks if track.id is not None]
        new = [track for track in self._tracks if track.id is None]
        matches = self._match(t, known, palms, range(len(palms)))
        matched = [palms[k].position for k in matches.values()]
        left = [
            k
            for k, palm in enumerate(palms)
            if k not in matches.values()
            and all(np.linalg.norm(palm.position - p) >= config.duplicate for p in matched)
        ]
        young = self._match(t, new, palms, left)
        self._tracks = known + [new[i] for i in young]  # a new hand is detected in every frame
        for i, k in matches.items():
            known[i].update(t, palms[k], config)
        for i, k in young.items():
            new[i].update(t, palms[k], config)
            new[i].vote(palms[k])
        for k in left:
            if k not in young.values():
                track = _Track(palms[k].position, t)
                track.vote(palms[k])
                self._tracks.append(track)
        self._assign_ids()
        index = {id(known[i]): k for i, k in matches.items()}
        index |= {id(new[i]): k for i, k in young.items()}
        return {track.id: index.get(id(track)) for track in self._tracks if track.id is not None}

    def _match(
        self, t: float, tracks: list[_Track], palms: Sequence[PalmMeasurement], among: Sequence[int]
    ) -> dict[int, int]:
        """Return which palm each track is, by the least sum of distances from predictions."""
        config = self._config
        if not tracks or not len(among):
            return {}
        cost = np.full((len(tracks), len(among)), NO_MATCH)
        for i, track in enumerate(tracks):
            gate = min(config.noise + config.max_speed * (t - track.t), config.max_gate)
            ahead = track.predict(t, config)
            for j, k in enumerate(among):
                if np.linalg.norm(palms[k].position - track.position) <= gate:
                    cost[i, j] = np.linalg.norm(palms[k].position - ahead)
        rows, columns = linear_sum_assignment(cost)
        pairs = zip(rows.tolist(), columns.tolist(), strict=True)
        return {i: among[j] for i, j in pairs if cost[i, j] < NO_MATCH}

    def _assign_ids(self) -> None:
        """Give ids to the hands that were detected often enough, by their early labels."""
        ids = (*IDS, *(f"hand{k}" for k in range(3, 5)))[: self._config.max_hands]
        used = {track.id for track in self._tracks}
        free = [id for id in ids if id not in used]
        ready = [track for track in self._tracks if track.id is None]
        ready = [track for track in ready if track.hits >= self._config.min_hits]
        if not free or not ready:
            return
        share = np.zeros((len(ready), len(free)))
        for i, track in enumerate(ready):
            total = sum(track.votes.values()) or 1.0
            share[i] = [track.votes.get(id, 0.0) / total for id in free]
            share[i] -= 1e-3 * np.arange(len(free))  # without labels: in the order of the ids
        for row, column in zip(*linear_sum_assignment(-share), strict=True):
            ready[int(row)].id = free[int(column)]
