"""Meshes that stand on a rendered table, before a camera that looks at its middle."""

import numpy as np
from scipy.spatial.transform import Rotation

from igrip.lab.rendering.layout import PlacedMesh, look_at

CAMERA = look_at(np.array([0.05, -0.62, 0.52]), np.array([0.0, 0.0, 0.07]))


def standing(model, x, y, yaw=0.4):
    """The mesh upright with its middle over (x, y)."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("z", yaw).as_matrix()
    at = pose[:3, :3] @ model.sphere[:3]
    pose[:3, 3] = [x - at[0], y - at[1], -model.vertices[:, 2].min()]
    return PlacedMesh(model, pose)
