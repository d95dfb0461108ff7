"""Random arms before a camera, for the palm of ``hands depth``: bare, or in whatever is worn.

Hands of many sizes and postures in gloves, mittens, sleeves and splints, or hooks in their place;
none of them is one of the arms that ``benchmarks.measure_worn_arms`` judges by. The frame of an arm
is as there: x to the fingers, z out of the back of the hand, the origin in the middle of the palm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import OAK, RenderConfig, RenderedScene
from igrip.lab.rendering.stereo import StereoNoise, measured_depth
from igrip.objects.model import build_model
from igrip.perception.registration.visibility import local_depths

Array = NDArray[np.float64]
Random = np.random.Generator
STEP = 2  # pixels; hands are looked for in a smaller picture
EDGE = -0.45  # y of the table's edge that people sit at [m]
VIEWS = 4  # of each arm
NEAR = 0.05  # a frame that shows nothing so near to the palm does not show the hand [m]


class ArmView(NamedTuple):
    """One arm in one frame, in the frame of the table [m]."""

    kind: str
    points: Array  # (n, 3), measured
    entry: Array  # (3,), where it comes in
    camera: Array  # (3,)
    palm: Array  # (3,)


def arm_views(number: int, seed: int) -> list[ArmView]:
    """Return a random arm from several sides; its kind goes by its number."""
    random = np.random.default_rng([seed, number])
    kind = list(KINDS)[number % len(KINDS)]
    mesh = trimesh.util.concatenate(KINDS[kind](random))
    if random.random() < 0.5:  # a left hand
        mesh.apply_transform(np.diag([1.0, -1.0, 1.0, 1.0]))
    model = build_model(f"{kind} {number}", mesh)
    poses = (_pose(random) for _ in range(VIEWS))
    views = ((pose, _observe(model, pose, random)) for pose in poses)
    return [ArmView(kind, *view, pose[:3, 3]) for pose, view in views if view is not None]


def _pose(random: Random) -> Array:
    """Return where an arm is: it reaches over the table's edge, more or less level."""
    palm = np.array([random.uniform(-0.35, 0.35), random.uniform(EDGE + 0.1, 0.3),
                     random.uniform(0.04, 0.25)])  # fmt: skip
    elbow = np.array([palm[0] + random.uniform(-0.35, 0.35), palm[1] - random.uniform(0.2, 0.5),
                      palm[2] + random.uniform(-0.05, 0.25)])  # fmt: skip
    x = (palm - elbow) / np.linalg.norm(palm - elbow)
    y = np.cross([0.0, 0.0, 1.0], x)
    y /= np.linalg.norm(y)
    pose = np.eye(4)
    roll = Rotation.from_rotvec([np.radians(random.uniform(-75.0, 75.0)), 0.0, 0.0]).as_matrix()
    pose[:3, :3] = np.stack([x, y, np.cross(x, y)], axis=1) @ roll
    pose[:3, 3] = palm
    return pose


def _observe(model: Any, pose: Array, random: Random) -> tuple[Array, Array, Array] | None:
    """Return points, entry and camera of an arm before a camera somewhere round the table."""
    azimuth, height = random.uniform(-np.pi, np.pi), np.radians(random.uniform(30.0, 85.0))
    away = random.uniform(0.6, 1.3)
    eye = away * np.array([np.cos(azimuth) * np.cos(height), np.sin(azimuth) * np.cos(height),
                           np.sin(height)])  # fmt: skip
    middle = pose[:3, 3] + [*random.uniform(-0.1, 0.1, 2), 0.0]
    world_from_camera = look_at(eye + middle, middle)
    noise = StereoNoise()
    scene = RenderedScene({"arm": PlacedMesh(model, pose)}, world_from_camera, OAK,
                          RenderConfig(noise=noise))  # fmt: skip
    _, depth, cosine = scene.picture()
    _, labels = scene.truth()
    measured = measured_depth(depth, cosine, OAK.fx, noise, random)
    measured = np.where(labels == 0, measured, 0.0).astype(np.float32)
    small = np.empty((OAK.height // STEP, OAK.width // STEP))
    local_depths(np.ascontiguousarray(measured), STEP, 0.15, 3.0, small)
    rows, columns = np.nonzero(small)
    pixels = (np.stack([columns, rows], axis=1) * float(STEP)).astype(np.float64)
    points = OAK.points(pixels, small[rows, columns])
    points = points @ world_from_camera[:3, :3].T + world_from_camera[:3, 3]
    inside = (points[:, 1] > EDGE) & (points[:, 2] > 0.012)
    entering = inside & (points[:, 1] < EDGE + 0.03)
    shows = np.linalg.norm(points[inside] - pose[:3, 3], axis=1) < NEAR
    if inside.sum() < 200 or not shows.any():
        return None
    points = points[inside]
    border = np.median(points[entering[inside]], axis=0) if entering.sum() >= 8 else None
    if border is None:  # it comes in over the edge of the picture: its end that is farthest back
        back = (points - pose[:3, 3]) @ -pose[:3, 0]
        border = np.median(points[back > np.quantile(back, 0.98)], axis=0)
        if np.quantile(back, 0.98) < 0.15:
            return None
    return points, border, world_from_camera[:3, 3]


def _rod(start: Sequence[float] | Array, end: Sequence[float] | Array, radius: float) -> Any:
    """Return a rounded rod between two points."""
    a, b = np.array(start, dtype=np.float64), np.array(end, dtype=np.float64)
    rod = trimesh.creation.capsule(
        height=float(np.linalg.norm(b - a)), radius=radius, count=[10, 10]
    )
    rod.apply_transform(trimesh.geometry.align_vectors([0, 0, 1], b - a))
    rod.apply_translation(0.5 * (a + b))
    return rod


def _ball(size: Sequence[float] | Array, at: Sequence[float] | Array) -> Any:
    """Return an ellipsoid of whole lengths ``size`` [m]."""
    body = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    body.apply_scale(size)
    body.apply_translation(at)
    return body


def _hull(balls: Sequence[Any]) -> Any:
    return trimesh.util.concatenate(balls).convex_hull


def _hand(random: Random, thick: float) -> list[Any]:
    """Return palm, fingers and thumb with cloth of ``thick`` round them [m]."""
    size = random.uniform(0.86, 1.14)
    broad, deep = size * random.uniform(0.9, 1.1), size * random.uniform(0.85, 1.15)
    knuckles, wrist = 0.036 * broad, 0.024 * broad
    half = 0.014 * deep + thick
    palm = _hull([
        _ball(3 * [2.0 * half], (x * size, y, 0.0))
        for x, y in ((0.030, knuckles - 0.010), (0.024, 0.012 - knuckles), (-0.046, wrist - 0.010),
                     (-0.046, 0.010 - wrist))
    ])  # fmt: skip
    parts = [palm]
    curl, spread = random.uniform(0.0, 1.0), np.radians(random.uniform(0.0, 14.0))
    for k, length in enumerate((0.072, 0.080, 0.075, 0.058)):
        y = knuckles * (0.85 - 0.57 * k)
        bend = np.radians(80.0) * np.clip(curl + random.normal(0.0, 0.12), 0.0, 1.1)
        aside = spread * (1.5 - k) / 1.5
        at = np.array([(0.040 - 0.004 * abs(k - 1)) * size, y, 0.0])
        for share, angle in ((0.52, bend), (0.48, 1.9 * bend)):
            way = np.array([np.cos(angle) * np.cos(aside), np.cos(angle) * np.sin(aside),
                            -np.sin(angle)])  # fmt: skip
            ahead = at + share * length * size * way
            parts.append(_rod(at, ahead, random.uniform(0.0075, 0.0095) * size + thick))
            at = ahead
    out, across = random.uniform(0.2, 1.0), random.uniform(-0.4, 0.6)
    root = np.array([-0.028, 0.9 * wrist, -0.006]) * [size, 1.0, size]
    joint = root + size * np.array([0.045, 0.012 + 0.025 * out, -0.012 * (1.0 - out)])
    tip = joint + size * np.array([0.026, 0.010 * out - 0.016 * across, -0.014 * across])
    return [
        *parts,
        _rod(root, joint, 0.011 * size + thick),
        _rod(joint, tip, 0.0095 * size + thick),
    ]


def _forearm(random: Random, start: float, radius: float, thin: float = 0.8) -> list[Any]:
    """Return a forearm from x = ``start`` back, that bends at the wrist and grows thicker."""
    bend = np.radians(random.normal(0.0, 10.0, 2))
    grows, parts = random.uniform(1.0, 1.5), []
    shares = np.linspace(0.0, 1.0, 5)
    for a, b in pairwise(shares):
        balls = []
        for share in (a, b):
            size = 2.0 * radius * (1.0 + (grows - 1.0) * min(1.0, 2.0 * share))
            balls.append(_ball([size, size, thin * size], (-0.5 * share, 0.0, 0.0)))
        parts.append(_hull(balls))
    arm = trimesh.util.concatenate(parts)
    arm.apply_transform(trimesh.transformations.euler_matrix(0.0, bend[0], bend[1]))
    arm.apply_translation((start, 0.0, 0.0))
    return [arm]


def _bare(random: Random) -> list[Any]:
    return [*_hand(random, random.uniform(0.0, 0.002)),
            *_forearm(random, -0.06, random.uniform(0.024, 0.032))]  # fmt: skip


def _glove(random: Random) -> list[Any]:
    """Return a glove, thick or with tubes along its fingers, with a cuff or without."""
    thick = random.uniform(0.001, 0.008)
    parts = _hand(random, thick)
    parts += _forearm(random, -0.06, random.uniform(0.027, 0.036))
    if random.random() < 0.6:
        start = random.uniform(-0.10, -0.05)
        radius = random.uniform(0.036, 0.056)
        parts += _forearm(random, start, radius, random.uniform(0.7, 1.0))
    if random.random() < 0.5:
        for y in np.linspace(-0.03, 0.03, int(random.integers(2, 6))):
            high = 0.020 + thick + random.uniform(0.0, 0.012)
            front = random.uniform(0.05, 0.11)
            parts.append(_rod((-0.07, 0.8 * y, high), (front, y, high - 0.01),
                              random.uniform(0.004, 0.009)))  # fmt: skip
    return parts


def _mitten(random: Random) -> list[Any]:
    size = random.uniform(0.85, 1.15)
    whole = [random.uniform(*span) for span in ((0.16, 0.20), (0.085, 0.115), (0.045, 0.07))]
    body = _ball(size * np.array(whole), (0.012 * size, 0.0, 0.0))
    tip = size * np.array([0.035, random.uniform(0.045, 0.07), -0.01])
    thumb = _rod(size * np.array([-0.03, 0.03, 0.0]), tip, 0.017 * size)
    return [body, thumb, *_forearm(random, -0.075, random.uniform(0.028, 0.05), 1.0)]


def _splint(random: Random) -> list[Any]:
    """Return a hand in a shell along the forearm, with a bar over the palm or rods to fingers."""
    parts = _hand(random, random.uniform(0.0, 0.003))
    parts += _forearm(random, -0.06, random.uniform(0.027, 0.034))
    front, back = random.uniform(-0.09, -0.01), random.uniform(-0.32, -0.2)
    shell = trimesh.creation.box(
        (front - back, random.uniform(0.07, 0.10), random.uniform(0.02, 0.06))
    )
    above = random.choice([-1.0, 1.0])
    shell.apply_translation((0.5 * (front + back), 0.0, above * random.uniform(0.0, 0.025)))
    parts.append(shell)
    high = above * random.uniform(0.022, 0.034)
    if random.random() < 0.7:
        at = random.uniform(0.0, 0.04)
        parts.append(_rod((at, -0.045, high), (at, 0.045, high), random.uniform(0.005, 0.012)))
    if random.random() < 0.5:
        for y in np.linspace(-0.03, 0.03, int(random.integers(1, 5))):
            parts.append(_rod((front - 0.03, y, high), (random.uniform(0.02, 0.10), y, high),
                              random.uniform(0.003, 0.006)))  # fmt: skip
    return parts


def _sleeve(random: Random) -> list[Any]:
    """Return a hand out of a wide sleeve, which may reach to the knuckles."""
    start = random.uniform(-0.14, -0.02)
    parts = _hand(random, random.uniform(0.0, 0.003))
    parts += _forearm(random, -0.06, random.uniform(0.025, 0.032))
    radius = random.uniform(0.042, 0.07)
    return [*parts, *_forearm(random, start - radius, radius, random.uniform(0.6, 1.0))]


def _hook(random: Random) -> list[Any]:
    """Return a prosthesis: two bent fingers on a socket; the palm is midway between them."""
    size, wide = random.uniform(0.85, 1.2), random.uniform(0.010, 0.022)
    parts = []
    for side in (wide, -wide):
        bow = size * np.array([(-0.06, side, 0.0), (-0.01, 1.6 * side, 0.0),
                               (0.04, 1.8 * side, -0.005), (0.075, 0.5 * side, -0.02)])  # fmt: skip
        parts += [_rod(a, b, random.uniform(0.006, 0.010)) for a, b in pairwise(bow)]
    parts.append(_rod((-0.10 * size, 0, 0), (-0.055 * size, 0, 0), random.uniform(0.018, 0.028)))
    start = random.uniform(-0.13, -0.09)
    return [*parts, *_forearm(random, start * size, random.uniform(0.034, 0.046), 1.0)]


KINDS: dict[str, Callable[[Random], list[Any]]] = {
    "bare": _bare, "glove": _glove, "mitten": _mitten, "splint": _splint, "sleeve": _sleeve,
    "hook": _hook,
}  # fmt: skip
