"""Objects by CosyPose, which runs in a process and a Python of its own (docs/cosypose.md).

Frames go out over a socket and poses come back. Only the newest frame is ever sent, nobody waits,
and a pose keeps the time of the frame that it was seen in, however late it comes.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.errors import IgripError
from igrip.objects.catalog import Catalog
from igrip.perception.poses import POSES
from igrip.perception.poses._cosypose_client import Answer, Remote
from igrip.rgbd import RgbdFrame
from igrip.settings import Settings, quantity

Array = NDArray[np.float64]

YCBV = (
    "002_master_chef_can", "003_cracker_box", "004_sugar_box", "005_tomato_soup_can",
    "006_mustard_bottle", "007_tuna_fish_can", "008_pudding_box", "009_gelatin_box",
    "010_potted_meat_can", "011_banana", "019_pitcher_base", "021_bleach_cleanser", "024_bowl",
    "025_mug", "035_power_drill", "036_wood_block", "037_scissors", "040_large_marker",
    "051_large_clamp", "052_extra_large_clamp", "061_foam_brick",
)  # fmt: skip
"""The objects of YCB-Video in the order of BOP, whose numbers begin at 1 (Hodan et al. 2018)."""
LABELS = {f"ycbv-obj_{number:06d}": name for number, name in enumerate(YCBV, 1)}
UNSURE = 1e-2  # by which a rotation that comes over the wire may fail to be one


class CosyPoseOptions(Settings):
    """The options of the pose finder ``cosypose``.

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
    least: float = quantity(0.7, "1", "poses with a lower score are left out", "CosyPose", ge=0)
    wait: float = quantity(0.0, "s", "for the answer to each frame; 0: never", ge=0)
    patience: float = quantity(10.0, "s", "without an answer: connect anew", "guess", gt=0)
    missing: float = quantity(
        2.0, "s", "an object not found for so long, and not under a hand, is not there", "guess",
        gt=0,
    )  # fmt: skip


class _Known(NamedTuple):
    said: ObjectPose
    world: Array  # of its middle


@POSES.register("cosypose")
class CosyPoses:
    """Poses from a CosyPose server.

    Parameters
    ----------
    catalog : Catalog
        The objects.
    options : mapping
        The fields of :class:`CosyPoseOptions`.

    Raises
    ------
    IgripError
        If the options cannot be read, or no server listens.
    """

    def __init__(self, catalog: Catalog, options: Mapping[str, Any]) -> None:
        try:
            self._options = CosyPoseOptions(**options)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            raise IgripError(f"cosypose: {where}: {first['msg']}") from error
        wanted = self._options.models
        labels = {**LABELS, **self._options.labels}
        self._models = {
            label: name for label, name in labels.items()
            if name in catalog and (wanted is None or name in wanted)
        }  # fmt: skip
        self._catalog = catalog
        self._known: dict[tuple[str, str], _Known] = {}
        self._newest: dict[str, float] = {}
        self._remote = Remote(self._options.host, self._options.port, self._options.patience)

    @property
    def problem(self) -> str | None:
        """What is wrong with the server now; None: nothing."""
        return self._remote.problem

    def find(
        self, frame: RgbdFrame, hands: Sequence[Array] = ()
    ) -> Mapping[str, ObjectPose | None]:
        """Send the frame, and return what is known; see the protocol of pose finders.

        ``t`` is the time of the frame that the server saw. ``score`` is CosyPose's own.
        """
        if frame.t < self._newest.get(frame.camera, -np.inf):  # another run
            self._known = {
                key: value for key, value in self._known.items() if key[0] != frame.camera
            }
        self._newest[frame.camera] = frame.t
        self._remote.offer(frame, self._options.send_depth)
        gone: list[str] = []
        for answer in self._remote.answers(self._options.wait):
            if answer.frame.t <= self._newest.get(answer.frame.camera, -np.inf):
                gone += self._take(answer, hands)
        told: dict[str, ObjectPose | None] = dict.fromkeys(gone)
        for (camera, name), known in self._known.items():
            if camera == frame.camera:
                told[name] = known.said
        return told

    def close(self) -> None:
        """Close the connection."""
        self._remote.close()

    def _take(self, answer: Answer, hands: Sequence[Array]) -> list[str]:
        """Keep what was found; return which objects are gone."""
        frame = answer.frame
        best: dict[str, tuple[float, Array]] = {}
        for found in answer.poses:
            seen = _read(found)
            if seen is None or seen[0] not in self._models or seen[1] < self._options.least:
                continue
            label, score, pose = seen
            name = self._models[label]
            if name not in best or score > best[name][0]:
                best[name] = score, pose
        for name, (score, camera_from_box) in best.items():
            self._known[frame.camera, name] = self._say(frame, name, score, camera_from_box)
        gone = []
        for (camera, name), known in list(self._known.items()):
            assert known.said.t is not None
            if camera != frame.camera or name in best:
                continue
            if frame.t - known.said.t > self._options.missing and not _under(frame, known, hands):
                del self._known[camera, name]
                gone.append(name)
        return gone

    def _say(self, frame: RgbdFrame, name: str, score: float, camera_from_box: Array) -> _Known:
        vertices = self._catalog[name].vertices
        box_from_mesh = np.eye(4)
        # BOP's meshes have their bounding box's centre at the origin, the catalogue's do not
        box_from_mesh[:3, 3] = -0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
        middle = frame.world_from_camera @ camera_from_box
        pose = middle @ box_from_mesh
        x, y, z = pose[:3, 3].tolist()
        a, b, c, d = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
        said = ObjectPose(
            position=(x, y, z), orientation=(a, b, c, d), model=name, t=frame.t, score=score,
            source="cosypose",
        )  # fmt: skip
        return _Known(said, middle[:3, 3])


def _read(found: Any) -> tuple[str, float, Array] | None:
    """Return label, score and camera from box of one pose, or None where it is none."""
    with contextlib.suppress(TypeError, ValueError, KeyError, OverflowError):
        label, score = str(found["label"]), float(found["score"])
        pose = np.array(found["camera_from_object"], dtype=np.float64)
        if pose.shape != (4, 4) or not np.isfinite(pose).all() or not 0.0 <= score <= 1.0:
            return None
        turn = pose[:3, :3]
        if np.abs(turn @ turn.T - np.eye(3)).max() > UNSURE or np.linalg.det(turn) < 0.0:
            return None
        if not (pose[3] == [0.0, 0.0, 0.0, 1.0]).all() or pose[2, 3] <= 0.0:
            return None
        return label, score, pose
    return None


def _under(frame: RgbdFrame, known: _Known, hands: Sequence[Array]) -> bool:
    """Whether a hand, (21, 2), may hide where an object was: its box, half as large again."""
    at = np.linalg.inv(frame.world_from_camera) @ np.append(known.world, 1.0)
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
