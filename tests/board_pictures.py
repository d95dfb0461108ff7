"""Pictures of a calibration board as a pinhole camera at a known place sees it."""

import cv2
import numpy as np

from igrip.perception.calibration.board import CELLS, MARGIN, pattern
from igrip.rgbd import Intrinsics, RgbdFrame

FINE = 3  # each pixel is the mean of so many squared
CAMERA = Intrinsics(1280, 720, 900.0, 902.0, 640.3, 358.8)


def looking_at(place, target=(0.0, 0.0, 0.0)):
    """Return world_from_camera of a camera at a place, its picture upright."""
    z = np.asarray(target, float) - place
    z /= np.linalg.norm(z)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    pose[:3, 3] = place
    return pose


def flat(board, cell=10):
    """Return the board's picture, and the matrix from its pixels (edges whole) to metres on it."""
    size = board.tag_size / (CELLS * cell)  # of a pixel [m]
    width, height = (round((length + 2 * MARGIN) / size) for length in board.extent)
    picture = np.full((height, width), 235, np.uint8)
    for id in board.ids:
        corner = board.corners(id)[1]
        i = round((corner[0] + board.extent[0] / 2 + MARGIN) / size)
        j = round((board.extent[1] / 2 - corner[1] + MARGIN) / size)
        picture[j : j + CELLS * cell, i : i + CELLS * cell] = np.maximum(pattern(id, cell), 20)
    left, top = -board.extent[0] / 2 - MARGIN, board.extent[1] / 2 + MARGIN
    return picture, np.array([[size, 0, left], [0, -size, top], [0, 0, 1]])


def see(board, pose, t=0.0, camera="camera", intrinsics=CAMERA, noise=2.0, depth=False, seed=0):
    """Return the frame of a camera that stands at a pose (world_from_camera)."""
    picture, metres = flat(board)
    k = intrinsics
    shift = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1]])  # from middles to edges of pixels
    there = np.linalg.inv(pose)
    onto = k.matrix @ there[:3][:, [0, 1, 3]]  # from (x, y, 1) on the board to pixels
    fine = np.diag([FINE, FINE, 1.0]) @ shift @ onto @ metres @ shift
    fine = np.linalg.inv(shift) @ fine
    grey = cv2.warpPerspective(
        picture, fine, (FINE * k.width, FINE * k.height), flags=cv2.INTER_LINEAR, borderValue=120
    )
    grey = cv2.resize(grey, (k.width, k.height), interpolation=cv2.INTER_AREA).astype(float)
    grey += np.random.default_rng(seed).normal(0.0, noise, grey.shape)
    colour = np.repeat(np.clip(np.round(grey), 0, 255).astype(np.uint8)[..., None], 3, axis=2)
    far = None
    if depth:  # of the plane z = 0
        v, u = np.mgrid[: k.height, : k.width]
        rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)
        far = (-pose[2, 3] / (rays @ pose[2, :3])).astype(np.float32)
    return RgbdFrame(t, colour, far, intrinsics, camera)
