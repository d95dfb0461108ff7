"""Pictures of AprilTags, warped by a homography that is known."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from igrip.rgbd import Intrinsics, RgbdFrame

CAMERA = Intrinsics(640, 400, 600.0, 602.0, 321.5, 198.0)
FINER = 3


def bitmap(number):
    """Return a tag as the AprilTag library prints it, 10 × 10 cells, white edge included."""
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    tag = cv2.aruco.generateImageMarker(family, number, 8)[::-1, ::-1]  # OpenCV's is upside down
    return np.pad(tag, 1, constant_values=255)


def pose(position, turn):
    """Return camera from tag; ``turn`` (rotation vector) from facing the camera upright [rad]."""
    matrix = np.eye(4)
    facing = np.diag([1.0, -1.0, -1.0])  # y up and z towards the camera
    matrix[:3, :3] = Rotation.from_rotvec(turn).as_matrix() @ facing
    matrix[:3, 3] = position
    return matrix


def draw(tags, camera=CAMERA, blur=0.7, noise=3.0, seed=0, t=0.0, depth=None, base=150.0):
    """Return a frame of tags: (number, size, camera_from_tag) each, over finely drawn edges."""
    rng = np.random.default_rng(seed)
    wide, high = camera.width * FINER, camera.height * FINER
    picture = np.full((high, wide), base, np.float32)
    fine = camera.scaled(wide, high)
    for number, size, camera_from_tag in tags:
        if camera_from_tag[:3, 2] @ camera_from_tag[:3, 3] >= 0.0:
            continue  # seen from behind
        cells = bitmap(number).astype(np.float32)
        # the ten cells' outer corners, from the upper left, clockwise
        half = 0.5 * size * 10 / 8
        corners = np.array([[-half, half], [half, half], [half, -half], [-half, -half]])
        points = np.column_stack([corners, np.zeros(4), np.ones(4)]) @ camera_from_tag.T
        pixels = fine.pixels(points[:, :3]).astype(np.float32)
        side = 10 * 16
        source = np.array([[0, 0], [side, 0], [side, side], [0, side]], np.float32) - 0.5
        warp = cv2.getPerspectiveTransform(source, pixels)
        large = np.kron(0.15 * 255 + 0.7 * cells, np.ones((16, 16), np.float32))
        inside = cv2.warpPerspective(np.ones_like(large), warp, (wide, high))
        drawn = cv2.warpPerspective(
            large, warp, (wide, high), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        picture = np.where(inside > 0.5, drawn, picture)
    small = picture.reshape(camera.height, FINER, camera.width, FINER).mean(axis=(1, 3))
    small = cv2.GaussianBlur(small, (0, 0), blur) if blur else small
    small = np.clip(small + rng.normal(0.0, noise, small.shape), 0, 255).astype(np.uint8)
    return RgbdFrame(t, np.repeat(small[..., None], 3, axis=2), depth, camera)
