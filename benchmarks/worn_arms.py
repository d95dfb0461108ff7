"""Arms that wear something, as meshes that a rendered camera sees, with the palm beside.

In the frame of an arm x points to the fingers, y to the left and z up, out of the back of the hand;
its origin is the middle of the palm. An arm is made of parts, so that cloth without depth can be
told from the rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import OAK, RenderConfig, RenderedScene
from igrip.lab.rendering.stereo import StereoNoise
from igrip.objects.model import ObjectModel, build_model
from igrip.rgbd import Intrinsics, RgbdFrame

Array = NDArray[np.float64]
DARK = "dark"  # a part whose name begins so gives hardly any depth
ARM = 0.55  # length of what is behind the wrist [m]
WRIST = -0.055  # x of the wrist [m]


def _rod(start: Sequence[float] | Array, end: Sequence[float] | Array, radius: float) -> Any:
    """Return a rounded rod between two points."""
    a, b = np.array(start, dtype=np.float64), np.array(end, dtype=np.float64)
    rod = trimesh.creation.capsule(
        height=float(np.linalg.norm(b - a)), radius=radius, count=[12, 12]
    )
    rod.apply_transform(trimesh.geometry.align_vectors([0, 0, 1], b - a))
    rod.apply_translation(0.5 * (a + b))  # it comes with its middle at the origin
    return rod


def _round(size: Sequence[float], at: Sequence[float] = (0.0, 0.0, 0.0)) -> Any:
    """Return an ellipsoid of whole lengths ``size`` [m]."""
    body = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    body.apply_scale(size)
    body.apply_translation(at)
    return body


def _palm(thick: float) -> Any:
    """Return a palm: broad at the knuckles, narrower at the wrist."""
    corners = [(0.024, 0.027), (0.024, -0.027), (-0.048, 0.018), (-0.048, -0.018)]
    balls = [_round(3 * [0.030 + 2 * thick], (x, y, 0.0)) for x, y in corners]
    return trimesh.util.concatenate(balls).convex_hull


def _hand(thick: float, curl: float) -> list[Any]:
    """Return palm and fingers; ``thick`` is cloth round them [m], ``curl`` 0 open to 1 a fist."""
    parts = [_palm(thick)]
    for k, length in enumerate((0.075, 0.085, 0.080, 0.062)):
        y = 0.032 - 0.021 * k
        knuckle = np.array([0.030, y, 0.0])
        bend = np.radians(85.0) * curl
        first = knuckle + 0.5 * length * np.array([np.cos(bend), 0.0, -np.sin(bend)])
        more = 1.9 * bend
        second = first + 0.5 * length * np.array([np.cos(more), 0.0, -np.sin(more)])
        parts += [_rod(knuckle, first, 0.009 + thick), _rod(first, second, 0.008 + thick)]
    side = 0.062 - 0.02 * curl
    root, joint, tip = (
        (-0.03, 0.03, -0.005),
        (0.02, side, -0.012),
        (0.05, side - 0.01 * curl, -0.015),
    )
    parts += [_rod(root, joint, 0.011 + thick), _rod(joint, tip, 0.010 + thick)]
    return parts


def _sleeve(radius: float, start: float = WRIST) -> Any:
    return _rod((start, 0.0, 0.0), (WRIST - ARM, 0.0, 0.0), radius)


@cache
def parts_of(kind: str) -> dict[str, ObjectModel]:
    """Return the parts of an arm by name; for the kinds see :data:`KINDS`."""
    joined = {
        name: trimesh.util.concatenate(meshes) for name, meshes in KINDS[kind]().items() if meshes
    }
    return {name: build_model(f"{kind} {name}", mesh) for name, mesh in joined.items()}


def _glove() -> dict[str, list[Any]]:
    return {"hand": _hand(0.004, 0.35), "cuff": [_sleeve(0.045, -0.075)]}


def _fist() -> dict[str, list[Any]]:
    return {"hand": _hand(0.003, 0.9), "arm": [_sleeve(0.030)]}


def _open() -> dict[str, list[Any]]:
    return {"hand": _hand(0.002, 0.05), "arm": [_sleeve(0.030)]}


def _orthosis() -> dict[str, list[Any]]:
    rods = [_rod((-0.12, y, 0.035), (0.09, y, 0.030), 0.004) for y in (0.03, 0.0, -0.03)]
    shell = trimesh.creation.box((0.20, 0.09, 0.05))
    shell.apply_translation((-0.17, 0.0, 0.005))
    bar = _rod((0.03, -0.045, 0.032), (0.03, 0.045, 0.032), 0.006)
    return {"hand": _hand(0.0, 0.45), "splint": [shell, bar, *rods], "arm": [_sleeve(0.033)]}


def _thick_sleeve() -> dict[str, list[Any]]:
    return {"hand": _hand(0.001, 0.5), "sleeve": [_sleeve(0.062, -0.10)]}


def _hook() -> dict[str, list[Any]]:
    bows = [
        [(-0.06, y, 0.0), (-0.01, 1.6 * y, 0.0), (0.04, 1.8 * y, -0.005), (0.075, 0.4 * y, -0.02)]
        for y in (0.014, -0.014)
    ]
    hooks = [_rod(a, b, 0.008) for bow in bows for a, b in pairwise(bow)]
    return {"hook": [*hooks, _rod((-0.09, 0, 0), (-0.055, 0, 0), 0.022)],
            "socket": [_sleeve(0.042, -0.12)]}  # fmt: skip


def _mitten() -> dict[str, list[Any]]:
    body = _round((0.19, 0.105, 0.055), (0.015, 0.0, 0.0))
    return {"mitten": [body, _rod((-0.03, 0.03, 0.0), (0.03, 0.065, -0.01), 0.018)],
            "sleeve": [_sleeve(0.045, -0.08)]}  # fmt: skip


def _dark_sleeve() -> dict[str, list[Any]]:
    return {"hand": _hand(0.0, 0.3), f"{DARK} sleeve": [_sleeve(0.042, -0.085)]}


KINDS = {
    "bare, open": _open, "bare, fist": _fist, "glove": _glove, "mitten": _mitten,
    "orthosis": _orthosis, "thick sleeve": _thick_sleeve, "dark sleeve": _dark_sleeve,
    "hook": _hook,
}  # fmt: skip


@dataclass(frozen=True)
class ArmPose:
    """Where an arm is: its palm, and where its elbow is, in the world [m]; its roll [rad]."""

    palm: Array
    elbow: Array
    roll: float = 0.0

    def matrix(self) -> Array:
        """Return world from arm, (4, 4)."""
        x = self.palm - self.elbow
        x = x / np.linalg.norm(x)
        y = np.cross([0.0, 0.0, 1.0], x)
        y /= np.linalg.norm(y)
        pose = np.eye(4)
        pose[:3, :3] = np.stack([x, y, np.cross(x, y)], axis=1)
        pose[:3, :3] = pose[:3, :3] @ Rotation.from_rotvec([self.roll, 0.0, 0.0]).as_matrix()
        pose[:3, 3] = self.palm
        return pose


@dataclass(frozen=True, eq=False)
class ArmFilm:
    """A table, what stands on it, and arms; made frame by frame."""

    scene: RenderedScene
    seed: int = 0

    def frame(
        self, t: float, arms: dict[str, tuple[str, ArmPose]],
        objects: dict[str, PlacedMesh] | None = None,
    ) -> RgbdFrame:  # fmt: skip
        """Render arms, by id: their kind and pose; ``objects`` replaces those of the scene."""
        random = np.random.default_rng([self.seed, round(1000 * t)])
        placed = dict(self.scene.objects if objects is None else objects)
        dark = []
        for id, (kind, pose) in arms.items():
            for name, model in parts_of(kind).items():
                if name.startswith(DARK):
                    dark.append(len(placed))
                placed[f"{id} {name}"] = PlacedMesh(model, pose.matrix())
        scene = replace(self.scene, objects=placed)
        frame = scene.frame(t, random)
        if not dark or frame.depth is None:
            return frame
        _, labels = scene.truth()
        cloth = np.isin(labels, dark)
        spots = gaussian_filter(random.standard_normal(cloth.shape), 3.0)
        lost = cloth & (spots < np.quantile(spots, 0.85))
        return replace(frame, depth=np.where(lost, 0.0, frame.depth).astype(np.float32))

    def skin(self, pose: ArmPose) -> Array:
        """Return the middle of the palm in the frame of the camera, (3,) [m]."""
        camera_from_world = np.linalg.inv(self.scene.world_from_camera)
        there: Array = camera_from_world[:3, :3] @ pose.palm + camera_from_world[:3, 3]
        return there


def table_before(
    azimuth: float = 0.0, elevation: float = 40.0, distance: float = 0.9,
    objects: dict[str, PlacedMesh] | None = None, noise: StereoNoise | None = StereoNoise(),  # noqa: B008
    camera: Intrinsics = OAK, seed: int = 0,
) -> ArmFilm:  # fmt: skip
    """Return a table before a camera; people sit at -y.

    ``azimuth`` [degrees] is 0 for a camera opposite them, 180 for one over their shoulder.
    """
    a, e = np.radians(azimuth), np.radians(elevation)
    eye = distance * np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])
    middle = np.array([0.0, -0.05, 0.05])
    pose = look_at(eye + middle, middle)
    scene = RenderedScene(objects or {}, pose, camera, RenderConfig(noise=noise))
    return ArmFilm(scene, seed)


def reach(
    start: Sequence[float], goal: Sequence[float], shoulder: Sequence[float], frames: int,
    rest: int = 0, roll: float = 0.0,
) -> Iterator[ArmPose]:  # fmt: skip
    """Yield a reach with minimum jerk, after some frames at rest."""
    a, b, elbow = (np.array(p, dtype=np.float64) for p in (start, goal, shoulder))
    for k in range(-rest, frames):
        s = max(k, 0) / max(frames - 1, 1)
        share = 10 * s**3 - 15 * s**4 + 6 * s**5
        palm = a + share * (b - a) + [0.0, 0.0, 0.08 * np.sin(np.pi * share)]
        yield ArmPose(palm, elbow + 0.3 * share * (b - a), roll)
