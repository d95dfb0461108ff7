"""A rendered camera: RGB-D frames of meshes on a table, whose true poses are known."""

from __future__ import annotations

import colorsys
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from igrip.lab.rendering.draw import draw_mesh
from igrip.lab.rendering.layout import LayoutConfig, PlacedMesh, random_camera, scatter
from igrip.lab.rendering.stereo import StereoNoise, measured_depth
from igrip.objects.catalog import Catalog
from igrip.rgbd import Array, Intrinsics, RgbdFrame
from igrip.settings import Settings, quantity

OAK = Intrinsics(640, 400, 493.0, 493.0, 319.5, 199.5)
"""An OAK-D S2's colour camera, 66° wide (Luxonis datasheet), at 640 x 400."""
WOOD, FLOOR = (176, 150, 118), (92, 96, 104)
TABLE, NOTHING, FLOOR_LABEL = -1, -3, -2


class RenderConfig(Settings):
    """What is drawn besides the objects, and how the camera errs."""

    noise: StereoNoise | None = StereoNoise()
    table_width: float = quantity(1.4, "m", "of the table, left to right", "guess", gt=0)
    table_depth: float = quantity(0.9, "m", "of the table, away from the camera", "guess", gt=0)
    table_height: float = quantity(0.73, "m", "of the table over the floor", "guess", gt=0)
    sd_colour: float = quantity(3.0, "1", "of each channel, of 255", "guess", ge=0)


@dataclass(frozen=True, eq=False)
class RenderedScene:
    """Objects on the table z = 0 of the world (z up), and a camera."""

    objects: dict[str, PlacedMesh]  # by id
    world_from_camera: Array  # (4, 4)
    intrinsics: Intrinsics = OAK
    config: RenderConfig = field(default_factory=RenderConfig)

    def truth(self) -> tuple[Array, NDArray[np.int32]]:
        """Return the true depth (h, w) [m], infinity for nothing, and labels, (h, w).

        A label is the number of the object in their order, -1 table, -2 floor, -3 nothing.
        """
        depth, labels = self._drawn
        return depth.copy(), labels.copy()

    @cached_property
    def _drawn(self) -> tuple[Array, NDArray[np.int32]]:
        shape = (self.intrinsics.height, self.intrinsics.width)
        depth, labels = np.full(shape, np.inf), np.full(shape, NOTHING, dtype=np.int32)
        self._draw_plane(depth, labels, -self.config.table_height, FLOOR_LABEL)
        self._draw_plane(depth, labels, 0.0, TABLE)
        camera_from_world = np.linalg.inv(self.world_from_camera)
        for number, placed in enumerate(self.objects.values()):
            camera_from_mesh = camera_from_world @ placed.pose
            sphere = placed.model.sphere.copy()
            sphere[:3] = camera_from_mesh[:3, :3] @ sphere[:3] + camera_from_mesh[:3, 3]
            bvh = placed.model.bvh
            draw_mesh(
                bvh.boxes, bvh.links, bvh.leaves, np.linalg.inv(camera_from_mesh), sphere,
                self.intrinsics, number, depth, labels,
            )  # fmt: skip
        return depth, labels

    def picture(self) -> tuple[Array, Array, Array]:
        """Return what is there, without noise.

        Colour (h, w, 3), depth (h, w) [m], and the cosine between surface and line of sight (h, w).
        """
        depth, labels = self.truth()
        rays = _rays(self.intrinsics)
        slant = (_normals(depth, self.intrinsics) * rays).sum(axis=2)
        cosine = np.abs(slant) / np.linalg.norm(rays, axis=2)
        return self._colour(labels, cosine), depth, cosine

    def frame(self, t: float, random: np.random.Generator) -> RgbdFrame:
        """Render what the camera sees at a time of exposure [s]."""
        colour, depth, cosine = self.picture()
        noisy = colour + self.config.sd_colour * random.standard_normal(colour.shape)
        if self.config.noise is None:
            measured = np.where(np.isfinite(depth), depth, 0.0).astype(np.float32)
        else:
            measured = measured_depth(depth, cosine, self.intrinsics.fx, self.config.noise, random)
        return RgbdFrame(
            t, np.clip(noisy, 0, 255).astype(np.uint8), measured, self.intrinsics,
            "rendered", self.world_from_camera,
        )  # fmt: skip

    def _draw_plane(
        self, depth: Array, labels: NDArray[np.int32], height: float, label: int
    ) -> None:
        """Draw the table, or the endless floor, where its side is up."""
        pose = self.world_from_camera
        rays = _rays(self.intrinsics) @ pose[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            z = (height - pose[2, 3]) / rays[..., 2]
            at = pose[:3, 3] + z[..., None] * rays
        visible = np.isfinite(z) & (z > 0.0) & (z < depth)
        if label == TABLE:
            visible &= np.abs(at[..., 0]) <= 0.5 * self.config.table_width
            visible &= np.abs(at[..., 1]) <= 0.5 * self.config.table_depth
        depth[visible], labels[visible] = z[visible], label

    def _colour(self, labels: NDArray[np.int32], cosine: Array) -> Array:
        palette = [colour_of(placed.model.name) for placed in self.objects.values()]
        palette += [(20, 20, 24), FLOOR, WOOD]  # as -3, -2, -1 count from the end
        shade = 0.35 + 0.65 * cosine
        result: Array = np.array(palette, dtype=np.float64)[labels] * shade[..., None]
        return result


def random_scene(
    catalog: Catalog,
    names: Sequence[str],
    random: np.random.Generator,
    layout: LayoutConfig | None = None,
    config: RenderConfig | None = None,
    intrinsics: Intrinsics = OAK,
) -> RenderedScene:
    """Return a scene of these models, scattered over the table, and a camera at a random place.

    Ids are the names of the models. For the other parameters see the classes they belong to.
    """
    layout = layout or LayoutConfig()
    placed = scatter([catalog[name] for name in names], layout, random)
    camera = random_camera(layout, random)
    objects = dict(zip(names, placed, strict=True))
    return RenderedScene(objects, camera, intrinsics, config or RenderConfig())


def colour_of(name: str) -> tuple[int, int, int]:
    """Return the colour a model is drawn in: always the same for its name."""
    digest = hashlib.sha256(name.encode()).digest()
    r, g, b = colorsys.hsv_to_rgb(digest[0] / 256, 0.55 + 0.4 * digest[1] / 256, 0.9)
    return round(255 * r), round(255 * g), round(255 * b)


def _rays(intrinsics: Intrinsics) -> Array:
    """Return the line of sight of each pixel, with z = 1, shape (h, w, 3)."""
    u = (np.arange(intrinsics.width) - intrinsics.cx) / intrinsics.fx
    v = (np.arange(intrinsics.height) - intrinsics.cy) / intrinsics.fy
    x, y = np.meshgrid(u, v)
    return np.stack([x, y, np.ones_like(x)], axis=2)


def _normals(depth: Array, intrinsics: Intrinsics) -> Array:
    """Return unit normals from the depth of neighbouring pixels, shape (h, w, 3)."""
    points = _rays(intrinsics) * np.where(np.isfinite(depth), depth, 1e3)[..., None]
    across = np.gradient(points, axis=1)
    down = np.gradient(points, axis=0)
    normals = np.cross(across, down)
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    result: Array = normals / np.maximum(length, 1e-12)
    return result
