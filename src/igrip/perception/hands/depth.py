"""``depth``: hands by where arms end, whatever they wear, from depth alone.

What comes in over the edge of the table and moves is an arm; docs/hands.md says how it is followed
and how well. The colour picture is not looked at.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from igrip.entities import Hand
from igrip.errors import IgripError
from igrip.perception.arms.background import Background, Depths
from igrip.perception.arms.blobs import Scene, find_blobs, scene_of
from igrip.perception.arms.table import NoTableError, Table
from igrip.perception.arms.tracks import Arm, ArmTracker
from igrip.perception.hands import HANDS, HandDetection
from igrip.perception.options import validated
from igrip.perception.registration.visibility import local_depths
from igrip.perception.transforms import inverse
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

MAX_DT = 0.2  # s; a longer gap between frames teaches no more
TABLE_EVERY = 15  # frames between looks at the table
COVER = 80  # points that stand for what an arm hides, at most
BESIDE = 0.05  # m from the middle line of the table, from which on an arm is the left or the right


class DepthHandsConfig(Settings):
    """How the background is learned and arms are told from it."""

    settle: float = quantity(
        1.0, "s", "for which a thing must stay to be background", "guess", gt=0
    )
    still: float = quantity(
        3.0, "s", "after which an arm that was there from the beginning and never moved is "
        "background", "guess", gt=0,
    )  # fmt: skip
    forget_after: float = quantity(
        60.0, "s", "without any movement, after which a hand is background", "guess", gt=0
    )
    width: int = quantity(
        320, "pixels", "at least, of the picture that arms are looked for in", "docs/hands.md",
        ge=80,
    )  # fmt: skip
    min_depth: float = quantity(0.15, "m", "of what is looked at", "guess", ge=0)
    max_depth: float = quantity(3.0, "m", "of what is looked at", "guess", gt=0)
    seed: int = quantity(0, "1", "of the random choices", "", ge=0)


@dataclass(eq=False)
class _CameraState:
    """What is remembered of one camera."""

    tracker: ArmTracker
    t: float
    table: Table | None = None
    background: Background | None = None
    frames: int = 0


@HANDS.register("depth")
class DepthHands:
    """Hands at the ends of arms over a table.

    ``options`` are the fields of :class:`DepthHandsConfig`.

    Attributes
    ----------
    problem : str or None
        Why no hand can be found just now: there is no table.
    """

    needs_depth = True

    def __init__(self, options: Mapping[str, Any] | DepthHandsConfig | None = None) -> None:
        self._config = validated(DepthHandsConfig, "hands depth", options)
        self._random = np.random.default_rng(self._config.seed)
        self._cameras: dict[str, _CameraState] = {}
        self.problem: str | None = None

    def detect(self, frame: RgbdFrame) -> list[HandDetection]:
        """Return the hands in a frame, the surest first.

        Raises
        ------
        IgripError
            If the frame has no depth.
        """
        if frame.depth is None:
            raise IgripError(
                "the hand detector 'depth' needs a camera with depth; or use 'tags' or 'mediapipe'"
            )
        config = self._config
        camera = self._cameras.get(frame.camera)
        if camera is None or frame.t < camera.t:  # another run: nothing is known
            camera = _CameraState(ArmTracker(config.forget_after, config.still), frame.t)
            self._cameras[frame.camera] = camera
        dt, camera.t = min(frame.t - camera.t, MAX_DT), frame.t
        depth, points, step = self._reduced(frame, frame.depth)
        if not self._find_table(camera, frame, points[depth > 0.0]):
            return []
        assert camera.table is not None
        if camera.background is None:
            camera.background = Background(depth.shape, config.settle)
        scene = scene_of(depth, points, camera.table)
        changes = camera.background.compare(depth, scene.tolerance, dt)
        blobs = find_blobs(scene, changes, camera.background)
        camera_place = camera.table.plane.table_from_camera[:3, 3]
        arms = camera.tracker.update(
            frame.t, blobs, camera_place, self._outside(camera, camera_place)
        )
        held = np.zeros(depth.shape, dtype=np.bool_)
        for arm in arms:
            if not camera.tracker.at_rest(arm, frame.t):
                held[arm.blob.pixels[:, 0], arm.blob.pixels[:, 1]] = True
        camera.background.learn(depth, scene.tolerance, dt, held, scene.above)
        found = [self._detection(camera, frame, scene, arm, step) for arm in arms]
        return sorted(found, key=lambda hand: -hand.score)

    def close(self) -> None:
        """Forget all cameras."""
        self._cameras.clear()

    def _reduced(self, frame: RgbdFrame, depth: Depths) -> tuple[Depths, Array, int]:
        """Return depth (h, w) at a smaller size, its points (h, w, 3), and the pixels' distance."""
        step = max(1, depth.shape[1] // self._config.width)
        rows, columns = (-(-n // step) for n in depth.shape)
        small = np.empty((rows, columns))
        whole = np.ascontiguousarray(depth, dtype=np.float32)
        local_depths(whole, step, self._config.min_depth, self._config.max_depth, small)
        v, u = np.mgrid[0:rows, 0:columns] * float(step)
        pixels = np.stack([u.ravel(), v.ravel()], axis=1)
        points = frame.intrinsics.points(pixels, small.ravel())
        return small.astype(np.float32), points.reshape(rows, columns, 3), step

    def _find_table(self, camera: _CameraState, frame: RgbdFrame, points: Array) -> bool:
        """Keep the table, or find it anew; whether there is one."""
        camera.frames += 1
        some = points[:: max(1, len(points) // 20000)]
        try:
            if camera.table is not None:
                if camera.table.is_where_it_was(some[::4], frame):
                    if camera.frames % TABLE_EVERY == 0:
                        camera.table.extend(some)
                    self.problem = None
                    return True
                if camera.tracker.arms and camera.table.is_seen_from(frame):
                    return True  # an arm hides much of it
            camera.table = camera.background = None
            camera.tracker.arms.clear()
            camera.table = Table(some, frame, self._random)
        except NoTableError as error:
            self.problem = f"hands 'depth': no table in the picture of {frame.camera}: {error}"
            return False
        self.problem = None
        return True

    def _outside(self, camera: _CameraState, camera_place: Array) -> Array:
        """Return a place beyond the table where people are, (3,): where arms came in before.

        Until then, opposite the camera.
        """
        assert camera.table is not None
        entered = [arm.entry for arm in camera.tracker.arms if arm.blob.entry is not None]
        centre = np.array([*camera.table.centre, 0.0])
        side = (
            np.mean(entered, axis=0) - centre
            if entered
            else (centre - camera_place) * [1.0, 1.0, 0.0]
        )
        length = float(np.linalg.norm(side))
        place: Array = centre + (side / length if length > 0.05 else np.array([0.0, 1.0, 0.0]))
        return place

    def _detection(
        self, camera: _CameraState, frame: RgbdFrame, scene: Scene, arm: Arm, step: int
    ) -> HandDetection:
        assert camera.table is not None
        camera_from_table = inverse(camera.table.plane.table_from_camera)
        world_from_table = frame.world_from_camera @ camera_from_table
        x, y, z = (world_from_table[:3, :3] @ arm.end.palm + world_from_table[:3, 3]).tolist()
        seen = camera_from_table[:3, :3] @ arm.end.palm + camera_from_table[:3, 3]
        pixel = frame.intrinsics.pixels(seen[None])
        cover = arm.blob.pixels[:: max(1, len(arm.blob.pixels) // COVER), ::-1] * float(step)
        std = arm.end.std
        score = 0.9 if arm.moved else 0.6
        hand = Hand(position=(x, y, z), t=frame.t, std=(std, std, std), score=score,
                    source=f"{frame.camera} depth")  # fmt: skip
        return HandDetection(np.vstack([pixel, cover]), score, _side(camera.table, arm), hand)


def _side(table: Table, arm: Arm) -> str | None:
    """Guess whether an arm is the left or the right of one who looks over the table."""
    inward = np.append(table.centre, 0.0) - arm.entry
    ahead = np.array([inward[0], inward[1]])
    # of the edge, not of the arm: whoever sits there looks straight over it
    if not len(table.outline):
        return None
    gaps = table.outline[:, :2] @ arm.entry[:2] + table.outline[:, 2]
    out = table.outline[int(np.argmax(gaps)), :2]
    rightward = np.array([-out[1], out[0]])  # up is out of the table
    off = -float(ahead @ rightward)
    if abs(off) < BESIDE:
        return None
    return "right" if off > 0.0 else "left"
