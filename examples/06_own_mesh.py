"""Meshes of one's own: a mug from CAD, in millimetres, becomes an object with grip zones."""

import sys
import tempfile
from pathlib import Path

import trimesh

import igrip
from igrip.viewer.grip_figure import draw_grip_zones

folder = Path(tempfile.mkdtemp())
body = trimesh.creation.cylinder(radius=40, height=95)  # a CAD program writes millimetres
handle = trimesh.creation.torus(major_radius=25, minor_radius=5)
handle.apply_transform(trimesh.transformations.rotation_matrix(1.5708, [1, 0, 0]))
handle.apply_translation([48, 0, 0])
trimesh.util.concatenate([body, handle]).export(folder / "mug.stl")
# its longest edge runs through the handle, so the file also declares which axis is upright
(folder / "objects.toml").write_text('[mug]\nunit = "mm"\naxis = [0.0, 0.0, 1.0]\n')

catalog = igrip.load_objects(folder)
mug = catalog["mug"]
size = mug.vertices.max(axis=0) - mug.vertices.min(axis=0)
print("the mug measures", " × ".join(f"{1000 * side:.0f}" for side in size), "mm")

picture = Path(sys.argv[1] if len(sys.argv) > 1 else folder / "mug.png")
draw_grip_zones([mug], igrip.Config().grip.pinch_threshold, picture)
print(f"grip zones: {picture.name}")
