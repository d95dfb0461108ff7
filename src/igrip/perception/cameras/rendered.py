"""``rendered:SEED``: a simulated camera before a simulated person, for trials without a camera.

``rendered:SEED?turn=MODEL`` shows a thing that is turned on the table instead, for ``igrip scan``.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from igrip.errors import CameraError, UnknownModelError
from igrip.lab.rendering.drawn_hand import OPEN_HAND, draw_hand, paste_hand
from igrip.lab.rendering.filmed_reach import film_reach
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.catalog import load_objects
from igrip.perception.cameras import CAMERAS, Camera
from igrip.perception.cameras._options import split_options
from igrip.perception.cameras._turned_thing import TurnedThing
from igrip.perception.opencv import load_opencv
from igrip.rgbd import RgbdFrame

RATE = 30.0  # frames a second, at most
STILLS = 8  # pictures of the table that take turns, each with its own noise: one takes a while
DEFAULTS: dict[str, Any] = {"turn": "", "step": 30.0}
MIN_STEP, MAX_STEP = 5.0, 90.0  # degrees


@CAMERAS.register("rendered")
def open_rendered(rest: str) -> Camera:
    """Open ``rendered``, ``rendered:SEED`` or ``rendered:SEED?turn=MODEL&step=DEGREES``."""
    text, options = split_options(rest, DEFAULTS)
    try:
        seed = int(text or "0")
    except ValueError:
        raise CameraError(f"rendered:{rest}: write rendered or rendered:SEED, a number") from None
    if seed < 0:
        raise CameraError(f"rendered:{rest}: the seed must not be negative")
    if not options["turn"]:
        return RenderedCamera(seed)
    if not MIN_STEP <= options["step"] <= MAX_STEP:
        raise CameraError(f"rendered:{rest}: step must be {MIN_STEP:g} to {MAX_STEP:g} degrees")
    try:
        model = load_objects("ycb")[options["turn"]]
    except UnknownModelError as error:
        raise CameraError(f"rendered:{rest}: {error}") from None
    return TurnedThing(model, options["step"], seed)


class RenderedCamera:
    """The paper's four objects on a table; a drawn hand reaches for one, goes back, and again.

    ``seed`` chooses the table, the person and the noise.
    """

    def __init__(self, seed: int = 0) -> None:
        self._random = np.random.default_rng(seed)
        self._film = film_reach(load_objects("ycb"), seed)
        self._palms = self._film.palms()
        self._stills = [self.scene.frame(0.0, self._random) for _ in range(STILLS)]
        self._turn = 0
        load_opencv("the rendered camera")
        mirror = 1.0 if self._film.task.hand == "right" else -1.0
        self._hand = draw_hand(OPEN_HAND * [mirror, 1.0])
        self._closed = threading.Event()

    @property
    def scene(self) -> RenderedScene:
        """What is on the table, and where the camera stands."""
        return self._film.scene

    def __iter__(self) -> Iterator[RgbdFrame]:
        """Yield frames until the camera is closed."""
        begin = due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            now = time.monotonic()
            due = max(due + 1.0 / RATE, now)
            yield self.frame(now, now - begin)

    def frame(self, t: float, elapsed: float | None = None) -> RgbdFrame:
        """Return the frame of time ``t`` [s]: the reach forth, then the same way back.

        ``elapsed`` is the time since the hand began, by default ``t`` [s].
        """
        last = len(self._palms) - 1
        k = int((t if elapsed is None else elapsed) * RATE + 1e-6) % (2 * last)
        palm = self._palms[min(k, 2 * last - k)]
        self._turn += 1
        frame = replace(self._stills[self._turn % STILLS], t=t)
        x, y = frame.intrinsics.pixels(palm[None])[0].tolist()
        return paste_hand(frame, self._hand, (x, y), float(palm[2]), np.pi)[0]

    def close(self) -> None:
        """End the iteration."""
        self._closed.set()
