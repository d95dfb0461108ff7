"""Where a fit starts: every way of resting, turned all round, settled on a cluster and rated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from igrip.compiled import kernel
from igrip.objects.stable_poses import StablePoses
from igrip.perception.registration.align import Annealing, Resting, align
from igrip.perception.registration.rigid_pose import RigidPose
from igrip.perception.registration.shape import Surface
from igrip.perception.registration.view import DepthView
from igrip.perception.registration.visibility import (
    Visibility,
    compare_with_depth,
    share_explained,
)
from igrip.rgbd import Array

TURNS = np.arange(12) * (2.0 * np.pi / 12)
ANNEALING = Annealing(0.04, 0.012, 6)
ANYWHERE = Resting(np.zeros(3), 0.0, 0.0)


class InitialPose(NamedTuple):
    """A pose from which a fit may start."""

    way: int  # of resting
    pose: RigidPose  # table-from-mesh
    visibility: Visibility
    cover: float  # share of the cluster's points that it explains, by how well


def initial_poses(
    points: Array, depths: Array, stable_poses: StablePoses, surface: Surface, view: DepthView
) -> list[InitialPose]:
    """Settle a mesh on a cluster from every way of resting and every turn about the vertical.

    ``points`` (n, 3) and ``depths`` (n,) are the cluster's, in the frame of the table, and along
    the optical axis [m].
    """
    shape = (len(stable_poses.heights), len(TURNS))
    rotations, translations = np.empty((*shape, 3, 3)), np.empty((*shape, 3))
    visibility, cover = np.empty((*shape, len(Visibility._fields))), np.empty(shape)
    _settle(
        points, depths, stable_poses.rotations, stable_poses.heights, surface, view,
        rotations, translations, visibility, cover,
    )  # fmt: skip
    return [
        InitialPose(
            way, RigidPose(rotations[way, turn], translations[way, turn]),
            Visibility(*visibility[way, turn].tolist()), float(cover[way, turn]),
        )
        for way, turn in np.ndindex(shape)
    ]  # fmt: skip


@kernel
def _settle(
    points, depths, rotations, heights, surface, view,
    out_rotations, out_translations, visibility, cover,
):  # fmt: skip
    """Write the poses (k, m, 3, 3) and (k, m, 3), visibility (k, m, 6) and cover (k, m)."""
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
    for way in range(rotations.shape[0]):
        for t in range(TURNS.shape[0]):
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
            visibility[way, t, 0], visibility[way, t, 1] = shares.match, shares.fit
            visibility[way, t, 2], visibility[way, t, 3] = shares.through, shares.hidden
            visibility[way, t, 4], visibility[way, t, 5] = shares.missing, shares.outside
            cover[way, t] = share_explained(points, depths, pose, surface, view)
            out_rotations[way, t] = rotation
            out_translations[way, t] = translation
