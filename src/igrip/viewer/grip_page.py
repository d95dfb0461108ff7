"""The grip zones on the objects' meshes, as a page in the browser (paper: Figure 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh

from igrip.objects.model import ObjectModel
from igrip.viewer.grip_zones import grip_zones
from igrip.viewer.server import open_server, plain, quiet

PALMAR, PINCH = (90, 130, 216), (211, 90, 192)
GAP = 0.08  # between two objects [m]


class GripPage:
    """A page with objects in a row, painted by the grip of a hand beside them.

    Parameters
    ----------
    models : sequence of ObjectModel
        The objects.
    pinch_from : float
        Border of the pinch zone, in half-lengths of the bounding cylinder.
    host, port : str, int
        Address to listen on; if the port is not free, the next free one is used.

    Raises
    ------
    MissingExtraError
        If viser is not installed.
    """

    def __init__(
        self,
        models: Sequence[ObjectModel],
        pinch_from: float,
        host: str = "127.0.0.1",
        port: int = 8080,
    ) -> None:
        self._server: Any = open_server(host, port)
        scene = self._server.scene
        scene.set_up_direction("+z")
        widths = [2.0 * model.radius + GAP for model in models]
        left = -0.5 * sum(widths)
        rows = ["| object | half-length | pinch beyond |", "| --- | --- | --- |"]
        for model, width in zip(models, widths, strict=True):
            self._draw(model, pinch_from, left + 0.5 * width)
            left += width
            half = 500.0 * model.length
            rows.append(f"| {plain(model.name)} | {half:.1f} mm | ±{pinch_from * half:.1f} mm |")
        self._server.initial_camera.position = (0.06, -0.75 * max(0.5, sum(widths)), 0.18)
        self._server.initial_camera.look_at = (0.06, 0.0, 0.0)
        self._server.gui.add_markdown(
            "### Grip by height\nA hand beside the blue part takes a palmar grip; beside the "
            "magenta part, or beyond it, a pinch. Grey: the bounding cylinder; red: its axis z.\n\n"
            + "\n".join(rows)
        )

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://localhost:{self._server.get_port()}"

    def close(self) -> None:
        """Close the page's server."""
        with quiet():
            self._server.stop()

    def _draw(self, model: ObjectModel, pinch_from: float, x: float) -> None:
        """Draw one object upright on its cylinder axis, its middle at z = 0."""
        half = 0.5 * model.length
        zones = grip_zones(model, pinch_from)
        colours = np.where(zones.pinch[:, None], PINCH, PALMAR).astype(np.uint8)
        mesh = trimesh.Trimesh(zones.vertices, zones.faces, face_colors=colours, process=False)
        scene, name = self._server.scene, f"/at {x:.4f}"
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
