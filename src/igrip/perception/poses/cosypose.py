"""Objects by CosyPose, which runs in a process and a Python of its own (docs/cosypose.md).

Frames go out over a socket and poses come back. Only the newest frame is ever sent, nothing waits,
and a pose keeps the time of the frame that it was estimated from, however late it comes.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field

from igrip.entities import ObjectPose
from igrip.objects.catalog import YCB_VIDEO, Catalog
from igrip.perception.options import validated
from igrip.perception.poses import POSES
from igrip.perception.poses._cosypose_client import Answer, PoseServerClient
from igrip.perception.transforms import is_rigid, object_pose
from igrip.rgbd import Array, RgbdFrame
from igrip.settings import Settings, quantity

LABELS = {f"ycbv-obj_{number:06d}": name for number, name in enumerate(YCB_VIDEO, 1)}
ROTATION_TOLERANCE = 1e-2  # by which a matrix may fail to be a rotation


class CosyPoseOptions(Settings):
    """The options of the pose estimator ``cosypose``.

    Attributes
    ----------
    host, port
        Where the server listens. It sees the pictures: let it be this machine.
    models : tuple of str or None
        Only these models are looked for.
    labels : mapping of str to str
        Model by the server's label, besides those of YCB-Video.
    send_depth : bool
        For a server that refines by depth.
    """

    host: str = "127.0.0.1"
    port: int = quantity(8768, "1", "of the server", ge=1, le=65535)
    models: tuple[str, ...] | None = None
    labels: Mapping[str, str] = Field(default_factory=dict)
    send_depth: bool = False
    min_score: float = quantity(0.7, "1", "of a pose", "CosyPose", ge=0)
    wait: float = quantity(0.0, "s", "for the reply to each frame; 0: never", ge=0)
    timeout: float = quantity(10.0, "s", "without a reply: reconnect", "guess", gt=0)
    missing_after: float = quantity(
        2.0, "s", "without being found, and not under a hand: an object is gone", "guess", gt=0
    )


class _LastPose(NamedTuple):
    message: ObjectPose
    t: float  # of the frame [s]
    centre: Array  # (3,) of its bounding box, in the world [m]


class _Found(NamedTuple):
    """One pose of the server's reply: the box is the mesh's bounding box, centred."""

    label: str
    score: float
    camera_from_box: Array


@POSES.register("cosypose")
class CosyPoses:
    """Poses from a CosyPose server; ``options`` are the fields of :class:`CosyPoseOptions`.

    Raises
    ------
    IgripError
        If the options cannot be read, or no server listens.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any]) -> None:
        self._options = validated(CosyPoseOptions, "cosypose", options)
        wanted = self._options.models
        labels = {**LABELS, **self._options.labels}
        self._models = {
            label: name for label, name in labels.items()
            if name in catalog and (wanted is None or name in wanted)
        }  # fmt: skip
        self._catalog = catalog
        self._last: dict[tuple[str, str], _LastPose] = {}  # by camera and model
        self._newest: dict[str, float] = {}  # time of the newest frame of each camera [s]
        self._client = PoseServerClient(
            self._options.host, self._options.port, self._options.timeout
        )

    @property
    def problem(self) -> str | None:
        """What is wrong with the server just now; None: nothing."""
        return self._client.problem

    def estimate(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Send the frame, and return what is known; see the protocol of pose estimators.

        ``t`` is the time of the frame that the server worked on. ``score`` is CosyPose's own.
        """
        if frame.t < self._newest.get(frame.camera, -np.inf):  # another run
            self._last = {key: value for key, value in self._last.items() if key[0] != frame.camera}
        self._newest[frame.camera] = frame.t
        self._client.offer(frame, self._options.send_depth)
        gone: list[str] = []
        for answer in self._client.answers(self._options.wait):
            if answer.frame.t <= self._newest.get(answer.frame.camera, -np.inf):
                gone += self._update(answer, hands)
        poses: dict[str, ObjectPose | None] = dict.fromkeys(gone)
        for (camera, name), last in self._last.items():
            if camera == frame.camera:
                poses[name] = last.message
        return poses

    def close(self) -> None:
        """Close the connection."""
        self._client.close()

    def _update(self, answer: Answer, hands: Sequence[Array]) -> list[str]:
        """Keep what was found; return which objects are gone."""
        frame = answer.frame
        best: dict[str, _Found] = {}
        for raw in answer.poses:
            found = _parse(raw)
            if found is None or found.score < self._options.min_score:
                continue
            name = self._models.get(found.label)
            if name is not None and (name not in best or found.score > best[name].score):
                best[name] = found
        for name, found in best.items():
            self._last[frame.camera, name] = self._last_pose(frame, name, found)
        gone = []
        for (camera, name), last in list(self._last.items()):
            if camera != frame.camera or name in best:
                continue
            missing = frame.t - last.t > self._options.missing_after
            if missing and not _under_hand(frame, last, hands):
                del self._last[camera, name]
                gone.append(name)
        return gone

    def _last_pose(self, frame: RgbdFrame, name: str, found: _Found) -> _LastPose:
        vertices = self._catalog[name].vertices
        box_from_mesh = np.eye(4)
        # BOP's meshes have their bounding box's centre at the origin, the catalogue's do not
        box_from_mesh[:3, 3] = -0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
        world_from_box = frame.world_from_camera @ found.camera_from_box
        pose = world_from_box @ box_from_mesh
        message = object_pose(pose, model=name, t=frame.t, score=found.score, source="cosypose")
        return _LastPose(message, frame.t, world_from_box[:3, 3])


def _parse(raw: Any) -> _Found | None:
    """Return one pose of the server's reply, or None where it is none."""
    with contextlib.suppress(TypeError, ValueError, KeyError, OverflowError):
        label, score = str(raw["label"]), float(raw["score"])
        pose = np.array(raw["camera_from_object"], dtype=np.float64)
        ahead = pose.shape == (4, 4) and is_rigid(pose, ROTATION_TOLERANCE) and pose[2, 3] > 0.0
        return _Found(label, score, pose) if ahead and 0.0 <= score <= 1.0 else None
    return None


def _under_hand(frame: RgbdFrame, last: _LastPose, hands: Sequence[Array]) -> bool:
    """Whether a hand, (21, 2), may hide where an object was: its box, half as large again."""
    at = np.linalg.inv(frame.world_from_camera) @ np.append(last.centre, 1.0)
    if at[2] <= 0.0:
        return True  # behind the camera
    pixel = frame.intrinsics.pixels(at[None, :3])[0]
    if (pixel < 0).any() or (pixel >= [frame.intrinsics.width, frame.intrinsics.height]).any():
        return True  # outside the picture
    for hand in hands:
        low, high = hand.min(axis=0), hand.max(axis=0)
        if (np.abs(pixel - 0.5 * (low + high)) < 0.75 * (high - low)).all():
            return True
    return False
