"""Whether a grasp holds an object, by plain rays against every triangle of its mesh."""

from __future__ import annotations

import numpy as np

FRICTION = np.radians(30.0)  # half-angle of the cones: a coefficient of 0.58
SNAP = 0.006  # m; a contact is so near to the mesh
PATCH = 0.008  # m; of the surface round a contact, whose mean normal counts


def hits(vertices, faces, origin, direction):
    """Return distances and faces of all crossings of a ray (Möller & Trumbore 1997)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    e1, e2 = b - a, c - a
    p = np.cross(direction, e2)
    det = np.einsum("fi,fi->f", e1, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origin - a
        u = np.einsum("fi,fi->f", s, p) / det
        q = np.cross(s, e1)
        v = q @ direction / det
        t = np.einsum("fi,fi->f", e2, q) / det
        met = (np.abs(det) > 1e-18) & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    rows = np.flatnonzero(met)
    return t[rows], rows


def contact_normal(vertices, faces, contact, outward):
    """Return the mean outward normal where a finger presses; None if there is no surface."""
    begin = contact + 0.02 * outward
    t, rows = hits(vertices, faces, begin, -outward)
    if not len(t):
        return None
    nearest = np.argmin(np.abs(t - 0.02))
    if abs(t[nearest] - 0.02) > SNAP:
        return None
    place = begin - t[nearest] * outward
    corners = vertices[faces]
    oriented = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    near = np.linalg.norm(corners.mean(axis=1) - place, axis=1) < PATCH
    near[rows[nearest]] = True
    # the edges and the far wall of a thin part are other sides
    faces_finger = oriented @ outward > 0.5 * np.linalg.norm(oriented, axis=1)
    oriented = oriented[near & faces_finger]
    total = oriented.sum(axis=0)
    size = np.linalg.norm(total)
    return total / size if size > 0 else None


def is_antipodal(vertices, faces, contacts, friction=FRICTION):
    """Whether two contacts hold: the line between them lies in both friction cones."""
    thumb, fingers = contacts
    width = np.linalg.norm(fingers - thumb)
    if not 0 < width <= 0.12:
        return False
    way = (fingers - thumb) / width
    for contact, outward in ((thumb, -way), (fingers, way)):
        normal = contact_normal(vertices, faces, contact, outward)
        if normal is None or normal @ outward < np.cos(friction):
            return False
    return True
