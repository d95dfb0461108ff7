"""Model of an object: its mesh, its own frame and cylinder, and its trees for the kernel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import trimesh
from numpy.typing import NDArray

from igrip.errors import ObjectsError
from igrip.mesh.bvh import Bvh, build_bvh, build_point_tree
from igrip.mesh.inscribed_spheres import inscribed_spheres
from igrip.objects.declared_grasp import DeclaredGrasp

Array = NDArray[np.float64]
Symmetry = Literal["none", "cylinder", "box"]


@dataclass(frozen=True, eq=False)
class ObjectModel:
    """A mesh as the estimator needs it. All in metres, in the frame of the mesh's file.

    The object frame has its z axis along the longest edge of the oriented bounding box, and its
    origin at the mid-length of the bounding cylinder about that axis (docs/decisions/0013).

    Attributes
    ----------
    name : str
        Name in the catalogue.
    vertices : (v, 3), faces : (f, 3)
        The mesh.
    centre : (3,)
        Centre of gravity, used by the distance derivative alone.
    mesh_from_object : (4, 4)
        Pose of the object frame in the frame of the mesh.
    length, radius : float
        Of the bounding cylinder [m].
    sphere : (4,)
        Centre and radius of a sphere that holds the mesh.
    symmetry : str
        ``none``, ``cylinder`` (any turn about z) or ``box`` (half turns about x, y, z).
    inscribed_spheres : (8, 4)
        Centres and radii of spheres inside it, see :mod:`igrip.mesh.inscribed_spheres`.
    bvh, vertex_tree : Bvh
        Trees of its triangles and of the vertices they use.
    grasps : tuple of DeclaredGrasp
        How the user says that it is grasped; empty: as its mesh allows (:mod:`igrip.grasps`).
    """

    name: str
    vertices: Array
    faces: NDArray[np.int64]
    centre: Array
    mesh_from_object: Array
    length: float
    radius: float
    sphere: Array
    inscribed_spheres: Array
    symmetry: Symmetry
    bvh: Bvh
    vertex_tree: Bvh
    grasps: tuple[DeclaredGrasp, ...] = ()

    @property
    def axis(self) -> Array:
        """Unit axis of the cylinder in the frame of the mesh, shape (3,)."""
        return self.mesh_from_object[:3, 2]

    @property
    def origin(self) -> Array:
        """Mid-point of the cylinder in the frame of the mesh, shape (3,) [m]."""
        return self.mesh_from_object[:3, 3]


def build_model(
    name: str,
    mesh: trimesh.Trimesh,
    symmetry: Symmetry = "none",
    axis: Array | None = None,
) -> ObjectModel:
    """Derive the model of an object from its mesh.

    Parameters
    ----------
    name : str
        Name in the catalogue.
    mesh : trimesh.Trimesh
        Mesh in metres; it need not be watertight.
    symmetry : str
        See :class:`ObjectModel`.
    axis : (3,), optional
        Direction of the cylinder's axis in the frame of the mesh, where the longest edge of the
        oriented bounding box is not the one to grasp along.

    Raises
    ------
    ObjectsError
        If the mesh has no surface.
    """
    vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64)
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int64)
    if not len(faces) or not np.isfinite(vertices).all():
        raise ObjectsError(f"{name}: the mesh has no faces, or coordinates that are not finite")
    corners = vertices[faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    faces = faces[area > 0.0]
    if not len(faces):
        raise ObjectsError(f"{name}: every face of the mesh is degenerate")
    used = np.unique(faces)
    bvh = build_bvh(vertices, faces)
    hull = _hull_points(vertices[used])
    frame, length, radius = _cylinder(hull, axis)
    middle = 0.5 * (hull.min(axis=0) + hull.max(axis=0))
    reach = float(np.linalg.norm(hull - middle, axis=1).max())
    return ObjectModel(
        name=name,
        vertices=vertices,
        faces=faces,
        centre=_centre_of_gravity(mesh, vertices[used]),
        mesh_from_object=frame,
        length=length,
        radius=radius,
        sphere=np.append(middle, reach * (1.0 + 1e-6) + 1e-9),
        inscribed_spheres=inscribed_spheres(vertices, np.asarray(mesh.faces), bvh),
        symmetry=symmetry,
        bvh=bvh,
        vertex_tree=build_point_tree(vertices[used]),
    )


def _hull_points(points: Array) -> Array:
    """Return the corners of the convex hull, or all points where the mesh is flat."""
    try:
        hull: Array = trimesh.convex.convex_hull(points).vertices
        return np.asarray(hull, dtype=np.float64)
    except Exception:  # qhull reports flat input by several kinds of error
        return points


def _centre_of_gravity(mesh: trimesh.Trimesh, points: Array) -> Array:
    """Return the centre of gravity; of the convex hull where the mesh encloses no volume."""
    if mesh.is_volume:
        return np.asarray(mesh.center_mass, dtype=np.float64)
    try:
        return np.asarray(trimesh.convex.convex_hull(points).center_mass, dtype=np.float64)
    except Exception:  # flat: qhull reports it by several kinds of error
        return np.asarray(mesh.centroid, dtype=np.float64)


def _cylinder(hull: Array, axis: Array | None) -> tuple[Array, float, float]:
    """Return mesh-from-object frame, length and radius of the bounding cylinder."""
    if axis is None:
        z, x = _longest_edge(hull)
    else:
        z = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
        x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    rotation = np.stack([x, np.cross(z, x), z], axis=1)
    local = hull @ rotation
    low, high = local[:, 2].min(), local[:, 2].max()
    centre, radius = _enclosing_circle(local[:, :2])
    frame = np.eye(4)
    frame[:3, :3] = rotation
    frame[:3, 3] = rotation @ np.array([centre[0], centre[1], 0.5 * (low + high)])
    return frame, float(high - low), radius


def _longest_edge(hull: Array) -> tuple[Array, Array]:
    """Return the directions of the longest and of another edge of the oriented bounding box.

    Where edges are of one length within 1 %, the one nearest to the file's z axis is taken, and the
    sign that points along it, so that a cube stands as its file does.
    """
    try:
        # by default trimesh drops candidates that are within 0.1 rad of one another: which ones
        # would hang on how the file is turned
        box_from_mesh, extents = trimesh.bounds.oriented_bounds(hull, ordered=False, angle_digits=4)
        directions = box_from_mesh[:3, :3]
    except Exception:  # flat: qhull reports it by several kinds of error
        extents, directions = np.ptp(hull, axis=0), np.eye(3)
    longest = np.flatnonzero(extents >= 0.99 * extents.max())
    chosen = longest[np.argmax(np.abs(directions[longest, 2]))]
    z = directions[chosen] / np.linalg.norm(directions[chosen])
    if z[np.flatnonzero(np.abs(z) > 1e-9)[-1]] < 0.0:
        z = -z
    return z, directions[(chosen + 1) % 3]


def _enclosing_circle(points: Array) -> tuple[Array, float]:
    """Return centre and radius of the smallest circle round points in the plane."""
    try:
        centre, radius = trimesh.nsphere.minimum_nsphere(points)
    except Exception:  # points on a line: qhull reports it by several kinds of error
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        radius = 0.0
    radius = max(float(radius), float(np.linalg.norm(points - centre, axis=1).max()))
    return np.asarray(centre, dtype=np.float64), radius
