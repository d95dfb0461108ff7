"""Where to start: every way of resting, turned all round, settled on a cluster and judged."""

from __future__ import annotations

import numpy as np

from igrip.compiled import kernel
from igrip.perception.registration.align import align
from igrip.perception.registration.visibility import explained, judge


@kernel
def try_starts(
    points, depths, rotations, heights, turns, samples, normals, values, origin, cell, middle,
    radius, depth, mask, pinhole, camera_from_table, base, spread, steps,
    out_rotations, out_translations, evidence, cover,
):  # fmt: skip
    """Settle a mesh on a cluster from every start.

    Parameters
    ----------
    points : (n, 3), depths : (n,)
        Of the cluster, in the frame of the table [m].
    rotations : (k, 3, 3), heights : (k,)
        Ways of resting.
    turns : (m,)
        Turns about the vertical [rad].
    samples, normals, values, origin, cell, middle, radius
        Of the shape (:class:`igrip.perception.registration.shape.Shape`).
    depth, mask, pinhole, base, spread
        As for :func:`igrip.perception.registration.visibility.judge`.
    camera_from_table : (4, 4)
        Pose of the table.
    steps : int
        Of the fit.
    out_rotations : (k, m, 3, 3), out_translations : (k, m, 3), written
        Table-from-mesh.
    evidence : (k, m, 6), cover : (k, m), written
        As ``judge`` gives it, and the share of the points that is explained, by how well.
    """
    up = np.zeros(3)
    information = np.empty((6, 6))
    rotation = np.empty((3, 3))
    translation = np.empty(3)
    seen_rotation = np.empty((3, 3))
    seen_translation = np.empty(3)
    eye = np.zeros(3)
    for i in range(3):
        for k in range(3):
            eye[i] -= camera_from_table[k, i] * camera_from_table[k, 3]
    mean = np.zeros(3)
    for n in range(points.shape[0]):
        mean += points[n]
    mean /= points.shape[0]
    towards = eye - mean
    towards /= np.sqrt((towards**2).sum())
    for way in range(rotations.shape[0]):
        for t in range(turns.shape[0]):
            c, s = np.cos(turns[t]), np.sin(turns[t])
            for k in range(3):
                rotation[0, k] = c * rotations[way, 0, k] - s * rotations[way, 1, k]
                rotation[1, k] = s * rotations[way, 0, k] + c * rotations[way, 1, k]
                rotation[2, k] = rotations[way, 2, k]
            # the middle of what the camera would see goes over the middle of what it sees
            x, y, weight = 0.0, 0.0, 1e-9
            for n in range(samples.shape[0]):
                facing = 0.0
                for i in range(3):
                    for k in range(3):
                        facing += towards[i] * rotation[i, k] * normals[n, k]
                if facing > 0.0:
                    weight += facing
                    for k in range(3):
                        x += facing * rotation[0, k] * samples[n, k]
                        y += facing * rotation[1, k] * samples[n, k]
            translation[0], translation[1] = mean[0] - x / weight, mean[1] - y / weight
            translation[2] = heights[way]
            align(
                points, values, origin, cell, middle, rotation, translation, 3, 0.0, up, 0.0,
                radius, 0.04, 0.012, steps, information,
            )  # fmt: skip
            for i in range(3):
                seen_translation[i] = camera_from_table[i, 3]
                for j in range(3):
                    seen_translation[i] += camera_from_table[i, j] * translation[j]
                    total = 0.0
                    for k in range(3):
                        total += camera_from_table[i, k] * rotation[k, j]
                    seen_rotation[i, j] = total
            judge(
                depth, mask, pinhole, seen_rotation, seen_translation, samples, normals,
                values, origin, cell, radius, base, spread, evidence[way, t],
            )  # fmt: skip
            _, cover[way, t] = explained(
                points, depths, rotation, translation, values, origin, cell, base, spread
            )
            out_rotations[way, t] = rotation
            out_translations[way, t] = translation
