"""The same pipeline frame by frame, without threads: for recordings, and to measure it."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Iterator

from igrip.observation import Observation
from igrip.perception.pipeline.merge import Merger, Result
from igrip.perception.pipeline.pipeline import DetectHands, EstimatePoses
from igrip.rgbd import RgbdFrame


def observe(
    frames: Iterable[RgbdFrame],
    hands: DetectHands | None,
    objects: EstimatePoses | None,
    objects_every: int = 3,
    hands_delay: float = 0.03,
    objects_delay: float = 0.1,
) -> Iterator[Observation]:
    """Work on every frame, and yield its results when a live pipeline would.

    Parameters
    ----------
    frames : iterable of RgbdFrame
        Of one camera, in order of time.
    hands, objects : function or None
        The stages, as of :class:`igrip.perception.pipeline.pipeline.Pipeline`.
    objects_every : int
        Objects are looked for in every so manyth frame.
    hands_delay, objects_delay : float
        From exposure to result [s].

    Yields
    ------
    Observation
        In order of time; the first frame is at 0 s.
    """
    merger: Merger | None = None
    waiting: list[tuple[float, int, Result]] = []
    number = itertools.count()
    for k, frame in enumerate(frames):
        if merger is None:
            merger = Merger(frame.t)
        while waiting and waiting[0][0] <= frame.t:
            now, _, result = heapq.heappop(waiting)
            yield merger.observation(result, now)
        detected = None
        if hands is not None:
            detected = hands(frame)
            heapq.heappush(waiting, (frame.t + hands_delay, next(number), detected))
        if objects is not None and k % objects_every == 0:
            poses = objects(frame, detected)
            heapq.heappush(waiting, (frame.t + objects_delay, next(number), poses))
    while waiting and merger is not None:
        now, _, result = heapq.heappop(waiting)
        yield merger.observation(result, now)
