"""The bounding cylinders of a frame's objects, in the world."""

from __future__ import annotations

from igrip.compiled import kernel

# columns
MIDDLE, AXIS, HALF_LENGTH, RADIUS, VELOCITY, WIDTH = 0, 3, 6, 7, 8, 11


@kernel
def place_cylinders(models, axes, origins, sizes, rotations, translations, velocities, out):
    """Write mid-point, unit axis, half-length, radius and velocity of each object's cylinder.

    Parameters
    ----------
    models : (o,) int64
        Which mesh each object has.
    axes : (m, 3, 3), origins : (m, 3)
        Object axes by columns and mid-point of the cylinder, in the frame of the mesh.
    sizes : (m, 2)
        Half-length and radius [m].
    rotations : (o, 3, 3), translations : (o, 3), velocities : (o, 3)
        World-from-mesh pose of each object [m], and its velocity [m/s].
    out : (o, 11), written
        World frame [m, m/s].
    """
    for o in range(models.shape[0]):
        mesh = models[o]
        for row in range(3):
            middle, axis = translations[o, row], 0.0
            for column in range(3):
                middle += rotations[o, row, column] * origins[mesh, column]
                axis += rotations[o, row, column] * axes[mesh, column, 2]
            out[o, MIDDLE + row] = middle
            out[o, AXIS + row] = axis
            out[o, VELOCITY + row] = velocities[o, row]
        out[o, HALF_LENGTH] = sizes[mesh, 0]
        out[o, RADIUS] = sizes[mesh, 1]
