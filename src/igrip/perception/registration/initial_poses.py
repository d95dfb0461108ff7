"""Where a fit starts: every way of resting, turned all round, settled on a cluster and rated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from igrip.compiled import kernel
from igrip.objects.stable_poses import StablePoses
from igrip.perception.registration.align import Annealing, Resting, align
from igrip.perception.registration.distinct_starts import TURNS
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import Surface
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import (
    Visibility,
    compare_with_depth,
    share_explained,
)
from igrip.rgbd import Array

ANNEALING = Annealing(0.04, 0.012, 6)
ANYWHERE = Resting(np.zeros(3), 0.0, 0.0)


class InitialPose(NamedTuple):
    """A pose from which a fit may start."""

    way: int  # of resting
    pose: RigidPose  # table-from-mesh
    visibility: Visibility
    cover: float  # share of the cluster's points that it explains, by how well


def initial_poses(
    points: Array, depths: Array, stable_poses: StablePoses, starts: NDArray[np.int64],
    surface: Surface, view: DepthView,
) -> list[InitialPose]:  # fmt: skip
    """Settle a mesh on a cluster from each start: a way of resting and a turn about the vertical.

    ``points`` (n, 3) and ``depths`` (n,) are the cluster's, in the frame of the table, and along
    the optical axis [m]; ``starts`` (k, 2) are numbers of ways and turns.
    """
    count = len(starts)
    rotations, translations = np.empty((count, 3, 3)), np.empty((count, 3))
    visibility, cover = np.empty((count, len(Visibility._fields))), np.empty(count)
    _settle(
        points, depths, stable_poses.rotations, stable_poses.heights, starts, surface, view,
        rotations, translations, visibility, cover,
    )  # fmt: skip
    return [
        InitialPose(
            int(starts[n, 0]), RigidPose(rotations[n], translations[n]),
            Visibility(*visibility[n].tolist()), float(cover[n]),
        )
        for n in range(count)
    ]  # fmt: skip


@kernel
def _settle(
    points, depths, rotations, heights, starts, surface, view,
    out_rotations, out_translations, visibility, cover,
):  # fmt: skip
    """Write the poses (k, 3, 3) and (k, 3), visibility (k, 6) and cover (k,)."""
    information = np.empty((6, 6))
    pose = RigidPose(np.empty((3, 3)), np.empty(3))
    rotation, translation = pose
    camera_from_mesh = RigidPose(np.empty((3, 3)), np.empty(3))
    camera_from_table, samples, normals = view.camera_from_table, surface.points, surface.normals
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
    for start in range(starts.shape[0]):
        way, t = starts[start, 0], starts[start, 1]
        c, s = np.cos(TURNS[t]), np.sin(TURNS[t])
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
        align(points, surface, pose, ANYWHERE, True, ANNEALING, information)
        for i in range(3):
            camera_from_mesh.translation[i] = camera_from_table[i, 3]
            for j in range(3):
                camera_from_mesh.translation[i] += camera_from_table[i, j] * translation[j]
                total = 0.0
                for k in range(3):
                    total += camera_from_table[i, k] * rotation[k, j]
                camera_from_mesh.rotation[i, j] = total
        shares = compare_with_depth(view, camera_from_mesh, surface)
        visibility[start, 0], visibility[start, 1] = shares.match, shares.fit
        visibility[start, 2], visibility[start, 3] = shares.through, shares.hidden
        visibility[start, 4], visibility[start, 5] = shares.missing, shares.outside
        cover[start] = share_explained(points, depths, pose, surface, view)
        out_rotations[start] = rotation
        out_translations[start] = translation
