"""``rendered?turn=MODEL``: a rendered thing that a drawn hand turns, step by step, all round."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import numpy as np

from igrip.lab.rendering.drawn_hand import OPEN_HAND, Sprite, draw_hand, paste_hand
from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.lab.simulation.table import yaw_rotation
from igrip.objects.model import ObjectModel
from igrip.perception.opencv import load_opencv
from igrip.rgbd import Array, RgbdFrame

RATE = 10.0  # frames a second
STILL, BUSY = 7, 4  # frames in which the thing stands, and in which the hand turns it
UNSURE = 8.0  # degrees by which a hand turns more or less than it means to
SHIFT = 0.005  # m by which it shifts the thing, one standard deviation
ROUNDS = 1.25  # turns, until the film is over
EYE = np.array([0.03, -0.42, 0.4])  # of the camera [m]; the thing stands at the origin


class TurnedThing:
    """The film of a thing that is turned.

    Parameters
    ----------
    model : ObjectModel
        Of the thing; z is up.
    step : float
        By which it is turned at a time [degrees].
    seed : int
        Of the noise, and of the hand.
    """

    def __init__(self, model: ObjectModel, step: float = 30.0, seed: int = 0) -> None:
        load_opencv("the rendered camera")
        self._random = np.random.default_rng(seed)
        self._model, self._camera = model, look_at(EYE, np.array([0.0, 0.0, 0.06]))
        self._hand: Sprite = draw_hand(OPEN_HAND)
        self._closed = threading.Event()
        places, yaw = [], 0.3
        for _ in range(int(ROUNDS * 360.0 / step) + 1):
            places.append(standing(model, yaw, self._random.normal(0.0, SHIFT, 2)))
            yaw += float(np.radians(step + self._random.uniform(-UNSURE, UNSURE)))
        self.poses: list[Array] = places  # world-from-mesh, (4, 4), of each still moment

    def __iter__(self) -> Iterator[RgbdFrame]:
        """Yield frames at their times, until the thing was turned all round and a little more."""
        begin = time.monotonic()
        for frame in self.film(begin):
            if self._closed.wait(max(0.0, frame.t - time.monotonic())):
                return
            yield frame

    def film(self, begin: float = 0.0) -> Iterator[RgbdFrame]:
        """Yield the frames, the first of them of time ``begin`` [s], as fast as one asks."""
        t = begin
        for pose in self.poses:
            scene = RenderedScene({"thing": PlacedMesh(self._model, pose)}, self._camera)
            for k in range(STILL + BUSY):
                frame = scene.frame(t, self._random)
                yield frame if k < STILL else self._with_hand(frame)
                t += 1.0 / RATE

    def _with_hand(self, frame: RgbdFrame) -> RgbdFrame:
        middle = np.linalg.inv(self._camera) @ [0.0, 0.0, 0.06, 1.0]
        x, y = frame.intrinsics.pixels(middle[None, :3])[0].tolist()
        return paste_hand(frame, self._hand, (x, y), float(middle[2]) - 0.08, 0.0)[0]

    def close(self) -> None:
        """End the iteration."""
        self._closed.set()


def standing(model: ObjectModel, yaw: float, place: Array) -> Array:
    """Return the pose, world-from-mesh, of a mesh that stands upright at a place, (2,) [m]."""
    pose = np.eye(4)
    pose[:3, :3] = yaw_rotation(yaw)
    at = pose[:3, :3] @ model.sphere[:3]
    pose[:3, 3] = [*(place - at[:2]), -float(model.vertices[:, 2].min())]
    return pose
