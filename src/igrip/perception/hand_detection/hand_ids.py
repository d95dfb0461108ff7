"""Which hand is which: by how hands move, not by what a finder calls them.

A finder's handedness flips, repeats and cannot be trusted from one picture to the next. Here a hand
keeps its id for as long as its movement can be followed; labels count only when it is new.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from igrip.settings import Settings, quantity

Array = NDArray[np.float64]

IDS = ("right", "left")
FAR = 1e3  # m: no match


class IdentityConfig(Settings):
    """How hands may move, and how long they are waited for."""

    hands: int = quantity(2, "1", "at most so many have ids", "DESIGN", ge=1, le=4)
    speed: float = quantity(
        4.0, "m/s", "no hand is faster; reaches peak at 1 to 2, blows at 6 to 10", "guess", gt=0
    )
    noise: float = quantity(0.05, "m", "a hand may seem to jump so far", "guess", ge=0)
    furthest: float = quantity(
        0.5, "m", "however long it was not seen, it is not looked for further away", "guess", gt=0
    )
    birth: int = quantity(3, "1", "a new hand is seen so often before it is one", "guess", ge=1)
    death: float = quantity(
        1.0, "s", "a hand that was not seen for longer loses its id", "guess", gt=0
    )
    one: float = quantity(
        0.04, "m", "what is so near to a known hand is that hand, seen twice", "guess", ge=0
    )
    coasting: float = quantity(
        0.15, "s", "time constant with which a hand that is not seen is thought to stop", "guess",
        gt=0,
    )  # fmt: skip


class Sighting(NamedTuple):
    """One hand as it was seen.

    Attributes
    ----------
    point : (3,)
        Its palm, in a frame that stands still [m].
    label : str or None
        ``left`` or ``right``, as the finder guesses.
    score : float
        How much the label counts.
    """

    point: Array
    label: str | None = None
    score: float = 1.0


@dataclass
class _Track:
    point: Array
    t: float
    velocity: Array = field(default_factory=lambda: np.zeros(3))
    hits: int = 1
    votes: dict[str, float] = field(default_factory=dict)
    id: str | None = None

    def predict(self, t: float, config: IdentityConfig) -> Array:
        """Return where the hand may be [m]: it goes on, and comes to rest."""
        stopping = config.coasting * -np.expm1((self.t - t) / config.coasting)
        ahead: Array = self.point + self.velocity * stopping
        return ahead

    def see(self, t: float, seen: Sighting, config: IdentityConfig) -> None:
        dt = max(t - self.t, 1e-3)  # s
        velocity = (seen.point - self.point) / dt
        speed = float(np.linalg.norm(velocity))
        if speed > config.speed:
            velocity *= config.speed / speed
        # half a weight on the newest: noise of 5 mm would else be 0.2 m/s
        self.velocity = velocity if self.hits == 1 else 0.5 * (self.velocity + velocity)
        self.point, self.t, self.hits = seen.point, t, self.hits + 1

    def vote(self, seen: Sighting) -> None:
        if seen.label is not None:
            self.votes[seen.label] = self.votes.get(seen.label, 0.0) + seen.score


class HandIdTracker:
    """Gives hands their ids: ``right`` and ``left``, then ``hand3`` and ``hand4``.

    Parameters
    ----------
    config : IdentityConfig, optional
        How they move.
    """

    def __init__(self, config: IdentityConfig | None = None) -> None:
        self._config = config or IdentityConfig()
        self._tracks: list[_Track] = []
        self._t = -np.inf

    def update(self, t: float, seen: Sequence[Sighting]) -> Mapping[str, int | None]:
        """Take one frame's hands and return which is which.

        Parameters
        ----------
        t : float
            Time of the frame [s]. Where it goes back, everything is forgotten.
        seen : sequence of Sighting
            In any order.

        Returns
        -------
        mapping of str to int or None
            By id: the index of its sighting; None: the hand is known and was not seen. No index
            twice. A hand that is too new has no id yet.
        """
        config = self._config
        if t < self._t:
            self._tracks = []
        self._t = t
        self._tracks = [track for track in self._tracks if t - track.t <= config.death]
        known = [track for track in self._tracks if track.id is not None]
        new = [track for track in self._tracks if track.id is None]
        matches = self._match(t, known, seen, range(len(seen)))
        left = [k for k in range(len(seen)) if k not in matches.values()]
        left = [
            k
            for k in left
            if all(
                np.linalg.norm(seen[k].point - seen[other].point) >= config.one
                for other in matches.values()
            )
        ]
        young = self._match(t, new, seen, left)
        self._tracks = known + [new[i] for i in young]  # a new hand is seen in every frame
        for i, k in matches.items():
            known[i].see(t, seen[k], config)
        for i, k in young.items():
            new[i].see(t, seen[k], config)
            new[i].vote(seen[k])
        for k in left:
            if k not in young.values():
                track = _Track(seen[k].point, t)
                track.vote(seen[k])
                self._tracks.append(track)
        self._name()
        index = {id(known[i]): k for i, k in matches.items()}
        index |= {id(new[i]): k for i, k in young.items()}
        return {track.id: index.get(id(track)) for track in self._tracks if track.id is not None}

    def _match(
        self, t: float, tracks: list[_Track], seen: Sequence[Sighting], among: Sequence[int]
    ) -> dict[int, int]:
        """Return which sighting each track is, by the least sum of distances from predictions."""
        config = self._config
        if not tracks or not len(among):
            return {}
        cost = np.full((len(tracks), len(among)), FAR)
        for i, track in enumerate(tracks):
            reach = min(config.noise + config.speed * (t - track.t), config.furthest)
            ahead = track.predict(t, config)
            for j, k in enumerate(among):
                if np.linalg.norm(seen[k].point - track.point) <= reach:
                    cost[i, j] = np.linalg.norm(seen[k].point - ahead)
        rows, columns = linear_sum_assignment(cost)
        return {
            int(i): among[int(j)] for i, j in zip(rows, columns, strict=True) if cost[i, j] < FAR
        }

    def _name(self) -> None:
        """Give ids to the hands that were seen often enough, by their early labels."""
        ids = (*IDS, *(f"hand{k}" for k in range(3, 5)))[: self._config.hands]
        taken = {track.id for track in self._tracks}
        free = [name for name in ids if name not in taken]
        ready = [track for track in self._tracks if track.id is None]
        ready = [track for track in ready if track.hits >= self._config.birth]
        if not free or not ready:
            return
        share = np.zeros((len(ready), len(free)))
        for i, track in enumerate(ready):
            total = sum(track.votes.values()) or 1.0
            share[i] = [track.votes.get(name, 0.0) / total for name in free]
            share[i] -= 1e-3 * np.arange(len(free))  # without labels: in the order of the ids
        for row, column in zip(*linear_sum_assignment(-share), strict=True):
            ready[int(row)].id = free[int(column)]
