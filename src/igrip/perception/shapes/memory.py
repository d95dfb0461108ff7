"""What is remembered of things: ids, shapes and colours, shared by the cameras that see them."""

from __future__ import annotations

import threading
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from igrip.objects.catalog import Catalog
from igrip.objects.model import ObjectModel
from igrip.perception.registration.shape import Shape
from igrip.perception.shapes.look import Look
from igrip.perception.shapes.names import ThingName
from igrip.rgbd import Array

SAME_PLACE = 0.05  # two cameras' views of one thing are so near [m]; guess
RECENT = 1.0  # s for which another camera's pose is where a thing is


@dataclass(eq=False)
class Remembered:
    """One thing."""

    model: ObjectModel
    shape: Shape
    look: Look
    position: Array  # (3,), of its middle, world [m]
    t: float  # when it was last seen [s]


class Memory:
    """Things by id; safe between threads.

    Parameters
    ----------
    catalog : Catalog
        Where their models are put.
    """

    def __init__(self, catalog: Catalog) -> None:
        self._catalog = catalog
        self._things: dict[str, Remembered] = {}
        self._count = 0
        self._lock = threading.Lock()

    def new_id(self, look: Look, names: Collection[ThingName]) -> str:
        """Return an id that no thing has: a name that the user gave to such a look, or a number."""
        with self._lock:
            for name in names:
                if name.name not in self._things and name.look.is_like(look):
                    return name.name
            while True:
                self._count += 1
                id = f"object_{self._count}"
                ours = id not in self._catalog or id in self._catalog.put_models
                if id not in self._things and ours:
                    return id

    def put(self, id: str, thing: Remembered) -> None:
        """Keep a thing, and its model in the catalogue."""
        with self._lock:
            self._catalog.put(thing.model)
            self._things[id] = thing

    def saw(self, id: str, position: Array, t: float) -> None:
        """Note where a thing is."""
        with self._lock:
            thing = self._things[id]
            thing.position, thing.t = position, t

    def forget(self, id: str) -> None:
        """Remove a thing that was none."""
        with self._lock:
            self._things.pop(id, None)

    def __getitem__(self, id: str) -> Remembered:
        return self._things[id]

    def things(self) -> dict[str, Remembered]:
        """Return all things by id."""
        with self._lock:
            return dict(self._things)

    def candidates(
        self, look: Look, position: Array, t: float, taken: Collection[str]
    ) -> list[str]:
        """Return ids of things that one at this place may be, the likeliest first.

        Those that another camera sees at the place come first, then those that look like it.
        """
        here, alike = [], []
        for id, thing in self.things().items():
            if id in taken:
                continue
            away = float(np.linalg.norm(thing.position - position))
            if away < SAME_PLACE and abs(t - thing.t) < RECENT:
                here.append((away, id))
            elif thing.look.is_like(look):
                alike.append((float(np.abs(thing.look.size - look.size).max()), id))
        return [id for _, id in (*sorted(here), *sorted(alike))]
