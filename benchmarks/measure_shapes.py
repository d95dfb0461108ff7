"""Print how well the pose estimator ``shapes`` finds and measures things it has no model of.

    python -m benchmarks.measure_shapes --scenes 40

Three unknown things of the YCB set upright on a table, at least 30 mm apart, noise like an OAK-D's;
the camera 0.7 to 1 m away, looking down 30 to 50 degrees. A thing is judged if at least half of the
pixels that it would fill alone are its own. After ``--seconds`` its model is compared with the mesh
that was rendered. Size: the largest error among the three edges of the oriented bounding box, of
its edge, those under 40 mm counted in shares of 40 mm. Axis: the upright one of what is round, the
longest edge of the others (fruit has none). Centre: the centre of gravity of the convex hull.
"""

from __future__ import annotations

import argparse
import os
import time

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import igrip
from igrip.entities import ObjectPose
from igrip.lab.rendering.layout import LayoutConfig, PlacedMesh
from igrip.lab.rendering.scene import RenderedScene, random_scene
from igrip.objects.model import ObjectModel
from igrip.perception.poses import POSES

Array = NDArray[np.float64]
KINDS = {
    "mug, cup": ("025_mug", "065-d_cups", "065-f_cups", "065-h_cups"),
    "bowl": ("024_bowl",),
    "box": ("003_cracker_box", "004_sugar_box", "009_gelatin_box", "008_pudding_box",
            "036_wood_block", "061_foam_brick", "010_potted_meat_can"),
    "bottle": ("006_mustard_bottle", "021_bleach_cleanser"),
    "can": ("002_master_chef_can", "005_tomato_soup_can", "007_tuna_fish_can"),
    "fruit": ("013_apple", "014_lemon", "015_peach", "016_pear", "017_orange", "018_plum"),
}  # fmt: skip
ROUND, NO_AXIS = ("mug, cup", "bowl", "can"), ("fruit",)
VISIBLE = 0.5
NEAR = 0.05  # m; what is found farther off is something else
SMALL = 0.04  # m


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=1.8)
    parser.add_argument("--lying", type=float, default=0.0, help="share of things that lie")
    parser.add_argument("--verbose", action="store_true")
    asked = parser.parse_args()
    catalog = igrip.load_objects("ycb")
    kind_of = {name: kind for kind, names in KINDS.items() for name in names}
    rows: dict[str, list[tuple[float, float, float]]] = {kind: [] for kind in KINDS}
    missed, judged, extra = 0, 0, 0
    took: list[float] = []
    first: list[float] = []
    for seed in range(asked.seed, asked.seed + asked.scenes):
        random = np.random.default_rng(seed)
        names = [str(random.choice(KINDS[str(kind)]))
                 for kind in random.choice(list(KINDS), 3, replace=False)]  # fmt: skip
        scene = random_scene(catalog, names, random, LayoutConfig(lying=asked.lying))
        estimator = POSES.get("shapes")(catalog, {})
        poses: dict[str, ObjectPose | None] = {}
        for k in range(1 + round(10 * asked.seconds)):
            frame = scene.frame(0.1 * k, random)
            begin = time.perf_counter()
            poses = dict(estimator.estimate(frame))
            (took if k else first).append(time.perf_counter() - begin)
        found = {id: pose for id, pose in poses.items() if pose is not None}
        for name, placed in scene.objects.items():
            near = min(found, key=lambda id: _apart(placed, catalog[id], found[id]), default=None)
            close = near is not None and _apart(placed, catalog[near], found[near]) < NEAR
            if _visible(scene, name) < VISIBLE:
                if near is not None and close:
                    del found[near]
                continue
            judged += 1
            if near is None or not close:
                missed += 1
                if asked.verbose:
                    print(f"{seed} {name}: MISSED", flush=True)
                continue
            kind = kind_of[name]
            row = _compare(placed, catalog[near], found.pop(near), kind)
            rows[kind].append(row)
            if asked.verbose:
                print(f"{seed} {name}: size {100 * row[0]:.0f} %, axis {row[1]:.0f}°, centre "
                      f"{1e3 * row[2]:.1f} mm", flush=True)  # fmt: skip
        extra += len(found)
    print(f"found {judged - missed} of {judged}; {extra} that are none")
    for kind, of_kind in rows.items():
        _print(kind, of_kind)
    _print("all", [row for of_kind in rows.values() for row in of_kind])
    print(
        f"a frame {1e3 * np.median(took):.1f} ms (median), {1e3 * np.quantile(took, 0.9):.0f} "
        f"(90 %); the first {1e3 * np.median(first):.0f} ms; load {os.getloadavg()[0]:.1f}"
    )


def _print(kind: str, rows: list[tuple[float, float, float]]) -> None:
    if not rows:
        return
    size, axis, centre = np.array(rows).T
    angles = axis[np.isfinite(axis)]
    turned = f"{100 * (angles < 10).mean():.0f} %" if len(angles) else "-"
    print(
        f"| {kind} | {len(rows)} | {100 * (size < 0.1).mean():.0f} % | "
        f"{100 * np.median(size):.1f} % | {turned} | {100 * (centre < 0.01).mean():.0f} % | "
        f"{1e3 * np.median(centre):.1f} mm |"
    )


def _world(model: ObjectModel, rotation: Array, translation: Array) -> Array:
    vertices: Array = model.vertices @ rotation.T + translation
    return vertices


def _of(model: ObjectModel, pose: ObjectPose) -> Array:
    rotation = Rotation.from_quat(pose.orientation).as_matrix()
    return _world(model, rotation, np.array(pose.position))


def _true(placed: PlacedMesh) -> Array:
    return _world(placed.model, placed.pose[:3, :3], placed.pose[:3, 3])


def _apart(placed: PlacedMesh, model: ObjectModel, pose: ObjectPose) -> float:
    middles = [0.5 * (v.min(axis=0) + v.max(axis=0)) for v in (_true(placed), _of(model, pose))]
    return float(np.linalg.norm(middles[0] - middles[1]))


def _compare(
    placed: PlacedMesh, model: ObjectModel, pose: ObjectPose, kind: str
) -> tuple[float, float, float]:
    """Return the errors of size (share), axis (degrees, nan: it has none) and centre (m)."""
    hulls = [trimesh.convex.convex_hull(v) for v in (_true(placed), _of(model, pose))]
    true, got = (np.sort(trimesh.bounds.oriented_bounds(h)[1]) for h in hulls)
    size = float((np.abs(got - true) / np.maximum(true, SMALL)).max())
    centre = float(np.linalg.norm(hulls[0].center_mass - hulls[1].center_mass))
    if kind in NO_AXIS:
        return size, np.nan, centre
    axis = Rotation.from_quat(pose.orientation).as_matrix() @ model.axis
    upright = placed.pose[:3, 2] if kind in ROUND else placed.pose[:3, :3] @ placed.model.axis
    angle = float(np.degrees(np.arccos(min(1.0, abs(float(axis @ upright))))))
    return size, angle, centre


def _visible(scene: RenderedScene, name: str) -> float:
    number = list(scene.objects).index(name)
    own = int((scene.truth()[1] == number).sum())
    alone = RenderedScene({name: scene.objects[name]}, scene.world_from_camera)
    return own / max(1, int((alone.truth()[1] == 0).sum()))


if __name__ == "__main__":
    main()
