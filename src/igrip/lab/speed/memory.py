"""Whether a long run grows."""

from __future__ import annotations

import os
from typing import Any

from igrip.estimator import Estimator
from igrip.lab.speed import scenes
from igrip.lab.speed.recorded import PAPER
from igrip.objects.catalog import Catalog
from igrip.observation import Observation


def memory(catalog: Catalog, frames: int) -> dict[str, Any]:
    """Return how much the process grows in the second half of a long run [MB]."""
    estimator = Estimator(catalog, PAPER)
    base = scenes.frames(360)
    length = base[-1].t + 1.0 / scenes.RATE
    sizes = []
    for number in range(frames):
        lap, k = divmod(number, len(base))
        message = base[k]
        estimator.update(Observation(message.t + lap * length, message.hands, message.objects))
        if number == frames // 2:
            sizes.append(_resident())
    sizes.append(_resident())
    return {"frames": frames, "growth_mb": sizes[1] - sizes[0], "resident_mb": sizes[1]}


def _resident() -> float:
    """Return the resident size of this process [MB]; its peak on systems without ``/proc``."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
