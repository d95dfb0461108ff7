"""Measure ``igrip scan``: rendered things, turned by a drawn hand, against their true surfaces.

Each is scanned from the frames of the rendered camera; then the pose estimator ``depth`` looks for
the scanned mesh where the true thing stands among others. Run from a checkout:
``python -m benchmarks.measure_scan box bottle mug can``.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from igrip.entities import ObjectPose
from igrip.lab.rendering.layout import PlacedMesh, look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.catalog import Catalog, load_objects
from igrip.objects.model import ObjectModel, build_model
from igrip.perception.cameras._turned_thing import TurnedThing, standing
from igrip.perception.poses.depth import DepthPoses
from igrip.perception.scan.catalogue_entry import Scan, write_entry
from igrip.perception.scan.options import ScanOptions
from igrip.perception.scan.scanner import Scanner
from igrip.perception.transforms import inverse

Array = NDArray[np.float64]
SAMPLES = 4000
THINGS = {"bottle": "006_mustard_bottle", "mug": "025_mug", "can": "005_tomato_soup_can"}
ROUND = ("can",)
YAWS = {"my_mug": -0.8}  # in the new scene [rad]: its handle is seen, else nothing tells its turn
BESIDE = "003_cracker_box"  # it stands beside the thing in the new scene


class Judged(NamedTuple):
    """How a scanned mesh differs from the true surface; lengths in metres."""

    to_true: Array  # (n,), distances of points on the scanned mesh
    to_scanned: Array  # (n,), distances of points on the true surface
    size: Array  # (3,), edges of the oriented bounding box, over the true ones


def thing(name: str) -> ObjectModel:
    """Return the model of a thing by its short name."""
    if name == "box":
        return build_model("box", trimesh.creation.box((0.12, 0.05, 0.09)))
    return load_objects("ycb")[THINGS[name]]


def scanned(film: TurnedThing, round_thing: bool) -> tuple[Scanner, trimesh.Trimesh]:
    """Return the scanner after a film, and the mesh."""
    scanner = Scanner(ScanOptions(), round_thing)
    for frame in film.film():
        scanner.add(frame)
        if scanner.done:
            break
    return scanner, scanner.mesh()


def judged(mesh: trimesh.Trimesh, model: ObjectModel, world_from_model: Array,
           world_from_mesh: Array) -> Judged:  # fmt: skip
    """Compare a mesh with a model; the poses are those of one moment."""
    mesh_from_model = inverse(world_from_mesh) @ world_from_model
    vertices = model.vertices @ mesh_from_model[:3, :3].T + mesh_from_model[:3, 3]
    true = trimesh.Trimesh(vertices, model.faces, process=False)
    ours, _ = trimesh.sample.sample_surface(mesh, SAMPLES, seed=0)
    theirs, _ = trimesh.sample.sample_surface(true, SAMPLES, seed=0)
    to_true = trimesh.proximity.closest_point(true, ours)[1]
    to_scanned = trimesh.proximity.closest_point(mesh, theirs)[1]
    return Judged(to_true, to_scanned, _sizes(mesh) / _sizes(true))


def found_again(catalog: Catalog, name: str, model: ObjectModel, mesh_from_model: Array) -> float:
    """Return how far ``depth`` puts the middle of a scanned mesh from its true place [m].

    In a new scene, beside another thing, seen by another camera; infinity: it is not found.
    """
    placed = PlacedMesh(model, standing(model, YAWS.get(name, 1.9), np.array([-0.08, 0.03])))
    other = load_objects("ycb")[BESIDE]
    beside = PlacedMesh(other, standing(other, 0.5, np.array([0.16, 0.08])))
    camera = look_at(np.array([0.05, -0.62, 0.52]), np.array([0.0, 0.0, 0.07]))
    scene = RenderedScene({"thing": placed, "beside": beside}, camera)
    estimator = DepthPoses(catalog, {"models": [name]})
    random = np.random.default_rng(1)
    poses: Mapping[str, ObjectPose | None] = {}
    for k in range(4):
        poses = estimator.estimate(scene.frame(0.6 * k, random))
    pose = poses.get(name)
    if pose is None:
        return float("inf")
    true = placed.pose @ inverse(mesh_from_model)
    middle = catalog[name].sphere[:3]
    got = Rotation.from_quat(pose.orientation).apply(middle) + np.array(pose.position)
    return float(np.linalg.norm(got - (true[:3, :3] @ middle + true[:3, 3])))


def _sizes(mesh: trimesh.Trimesh) -> Array:
    hull = trimesh.convex.convex_hull(mesh.vertices)
    return np.sort(np.asarray(trimesh.bounds.oriented_bounds(hull)[1], dtype=np.float64))


def main() -> None:
    """Scan the things that are named, and print a row for each."""
    print("thing   views  to true: median, 95 %  to scanned: median, 95 %  size   found   time")
    for name in sys.argv[1:] or ["box", *THINGS]:
        begin = time.perf_counter()
        model = thing(name)
        film = TurnedThing(model)
        scanner, mesh = scanned(film, name in ROUND)
        seconds = time.perf_counter() - begin
        world_from_mesh = scanner.first_pose()
        result = judged(mesh, model, film.poses[0], world_from_mesh)
        with tempfile.TemporaryDirectory() as folder:
            scan = Scan(mesh, scanner.picture(), name in ROUND, {})
            write_entry(Path(folder), f"my_{name}", scan)
            away = found_again(
                load_objects(folder), f"my_{name}", model, inverse(world_from_mesh) @ film.poses[0]
            )
        a, b = 1e3 * result.to_true, 1e3 * result.to_scanned
        off = 100.0 * float(np.abs(result.size - 1.0).max())
        print(
            f"{name:7s} {1 if name in ROUND else len(scanner.views):5d}  {np.median(a):5.2f} mm, "
            f"{np.percentile(a, 95):5.2f} mm      {np.median(b):5.2f} mm, "
            f"{np.percentile(b, 95):5.2f} mm         {off:4.1f} %"
            f"  {1e3 * away:5.1f} mm  {seconds:4.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
