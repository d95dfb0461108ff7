"""The grip zones on the objects' meshes, as a page in the browser (paper: Figure 2)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh

from igrip.objects.model import ObjectModel
from igrip.viewer.grip_zones import PALMAR, PINCH, grip_zones
from igrip.viewer.server import Page, plain

GAP = 0.08  # between two objects [m]


class GripPage(Page):
    """A page with objects in a row, painted by the grip of a hand beside them.

    ``pinch_from`` is the border of the pinch zone, in half-lengths of the bounding cylinder.
    """

    def __init__(
        self,
        models: Sequence[ObjectModel],
        pinch_from: float,
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        super().__init__(host, port)
        scene = self.server.scene
        scene.set_up_direction("+z")
        widths = [2.0 * model.radius + GAP for model in models]
        left = -0.5 * sum(widths)
        rows = ["| object | half-length | pinch beyond |", "| --- | --- | --- |"]
        for model, width in zip(models, widths, strict=True):
            self._draw(model, pinch_from, left + 0.5 * width)
            left += width
            half = 500.0 * model.length
            rows.append(f"| {plain(model.name)} | {half:.1f} mm | ±{pinch_from * half:.1f} mm |")
        self.server.initial_camera.position = (0.06, -0.75 * max(0.5, sum(widths)), 0.18)
        self.server.initial_camera.look_at = (0.06, 0.0, 0.0)
        self.server.gui.add_markdown(
            "### Grip by height\nA hand beside the blue part takes a palmar grip; beside the "
            "magenta part, or beyond it, a pinch. Grey: the bounding cylinder; red: its axis z.\n\n"
            + "\n".join(rows)
        )

    def _draw(self, model: ObjectModel, pinch_from: float, x: float) -> None:
        """Draw one object upright on its cylinder axis, its middle at z = 0."""
        half = 0.5 * model.length
        zones = grip_zones(model, pinch_from)
        colours = np.where(zones.pinch[:, None], PINCH, PALMAR).astype(np.uint8)
        mesh = trimesh.Trimesh(zones.vertices, zones.faces, face_colors=colours, process=False)
        scene, name = self.server.scene, f"/at {x:.4f}"
        scene.add_mesh_trimesh(f"{name}/mesh", mesh, position=(x, 0.0, 0.0))
        scene.add_cylinder(
            f"{name}/cylinder", radius=model.radius, height=model.length, color=(130, 130, 130),
            opacity=0.18, cast_shadow=False, position=(x, 0.0, 0.0),
        )  # fmt: skip
        top = 1.35 * half
        scene.add_line_segments(
            f"{name}/axis", np.array([[[x, 0.0, 0.0], [x, 0.0, top]]], np.float32), (208, 32, 32),
            thickness=2.0, thickness_units="screen",
        )  # fmt: skip
        scene.add_label(f"{name}/label", model.name, position=(x, 0.0, top), anchor="bottom-center")
