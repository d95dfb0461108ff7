"""A rendered scene with pictures in front of it: a hand or an arm, for one."""

from dataclasses import dataclass

import numpy as np

from igrip.lab.rendering.scene import RenderedScene


@dataclass(frozen=True, eq=False)
class Overlay:
    """A picture with depth; it may stick out of the rendered one.

    Colour (h, w, 3), where there is anything (h, w), depth (h, w) [m], top-left pixel.
    """

    colour: np.ndarray
    mask: np.ndarray
    depth: np.ndarray
    x: int
    y: int

    def put(self, colour, depth, cosine):
        """Put it where it is nearer than what is there."""
        height, width = depth.shape
        h, w = self.mask.shape
        top, left = max(0, self.y), max(0, self.x)
        bottom, right = min(height, self.y + h), min(width, self.x + w)
        if top >= bottom or left >= right:
            return
        into = np.s_[top:bottom, left:right]
        of = np.s_[top - self.y : bottom - self.y, left - self.x : right - self.x]
        nearer = self.mask[of] & (self.depth[of] < depth[into])
        colour[into][nearer] = self.colour[of][nearer]
        depth[into][nearer] = self.depth[of][nearer]
        cosine[into][nearer] = 1.0


@dataclass(frozen=True, eq=False)
class OverlaidScene(RenderedScene):
    """A scene before which there are overlays."""

    overlays: tuple[Overlay, ...] = ()

    def picture(self):
        """Return what is there, overlays included."""
        colour, depth, cosine = super().picture()
        for overlay in self.overlays:
            overlay.put(colour, depth, cosine)
        return colour, depth, cosine


def overlaid(scene, overlays):
    """Return a scene with overlays before it."""
    parts = scene.objects, scene.world_from_camera, scene.intrinsics, scene.config
    return OverlaidScene(*parts, tuple(overlays))
