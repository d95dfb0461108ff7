"""The same chain frame by frame, without threads: for recordings, and to measure what it sees."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Iterator

from igrip.observation import Observation
from igrip.perception.pipeline.merge import HandsFound, Merge, ObjectsFound
from igrip.perception.pipeline.pipeline import FindHands, FindObjects
from igrip.rgbd import RgbdFrame


def observe(
    frames: Iterable[RgbdFrame],
    hands: FindHands | None,
    objects: FindObjects | None,
    objects_every: int = 3,
    hands_delay: float = 0.03,
    objects_delay: float = 0.1,
) -> Iterator[Observation]:
    """Work on every frame, and say what was found when a live chain would have.

    Parameters
    ----------
    frames : iterable of RgbdFrame
        Of one camera, in order of time.
    hands, objects : function or None
        As for :class:`igrip.perception.pipeline.pipeline.Pipeline`, already made.
    objects_every : int
        Objects are looked for in every so manyth frame.
    hands_delay, objects_delay : float
        From exposure to result [s].

    Yields
    ------
    Observation
        In order of time; the first frame is at 0 s.
    """
    merge: Merge | None = None
    waiting: list[tuple[float, int, HandsFound | ObjectsFound]] = []
    number = itertools.count()
    for k, frame in enumerate(frames):
        if merge is None:
            merge = Merge(frame.t)
        while waiting and waiting[0][0] <= frame.t:
            now, _, found = heapq.heappop(waiting)
            yield merge.take(found, now)
        seen = None
        if hands is not None:
            seen = hands(frame)
            heapq.heappush(waiting, (frame.t + hands_delay, next(number), seen))
        if objects is not None and k % objects_every == 0:
            found = objects(frame, seen)
            heapq.heappush(waiting, (frame.t + objects_delay, next(number), found))
    while waiting and merge is not None:
        now, _, found = heapq.heappop(waiting)
        yield merge.take(found, now)
