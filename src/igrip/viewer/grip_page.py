"""The grip zones on the objects' meshes, as a page in the browser (paper: Figure 2)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from igrip.objects.model import ObjectModel
from igrip.viewer.grasp_lines import grasp_lines
from igrip.viewer.grip_zones import PALMAR, PINCH, grip_zones
from igrip.viewer.page_messages import encode_mesh
from igrip.viewer.server import Viewer

GAP = 0.08  # between two objects [m]
PALMAR_HEX, PINCH_HEX = ("#{:02x}{:02x}{:02x}".format(*colour) for colour in (PALMAR, PINCH))


class GripPage(Viewer):
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
        self.set_up(mode="static")
        widths = [2.0 * model.radius + GAP for model in models]
        left = -0.5 * sum(widths)
        objects: list[dict[str, Any]] = []
        lines: list[dict[str, Any]] = []
        rows = []
        for k, (model, width) in enumerate(zip(models, widths, strict=True)):
            x = left + 0.5 * width
            left += width
            objects += self._paint(model, pinch_from, x, 2 * k)
            half = 0.5 * model.length
            border = pinch_from * half
            lines.append({"colour": "#d02020", "points": [x, 0, 0, x, 0, 1.35 * half]})
            lines.append({"colour": "#5b6672", "points": _outline(x, model.radius, half)})
            lines += grasp_lines(model, np.array([x, 0.0, 0.0]))
            rows.append([model.name, f"{1e3 * half:.1f} mm", f"±{1e3 * border:.1f} mm"])
        scene = {"t": 0.0, "objects": objects, "hands": [], "rows": [], "lines": lines}
        self.publish("scene", scene)
        columns = ["object", "half-length", "pinch beyond"]
        self.publish("borders", {"columns": columns, "rows": rows})
        text = (
            "a hand beside the blue part takes a palmar grip, beside the magenta one a pinch;"
            " lines: grasp candidates, green with the palm and orange with the fingers"
        )
        self.note("Grip by height", text)

    def _paint(
        self, model: ObjectModel, pinch_from: float, x: float, number: int
    ) -> list[dict[str, Any]]:
        """Return one object upright on its cylinder axis, its middle at z = 0, in two parts."""
        zones = grip_zones(model, pinch_from)
        half = 0.5 * model.length
        parts = []
        for k, (pinch, colour) in enumerate(((False, PALMAR_HEX), (True, PINCH_HEX))):
            faces = zones.faces[zones.pinch == pinch]
            if not len(faces):
                continue
            data = encode_mesh(zones.vertices, faces)
            self.add_resource(f"/mesh/{number + k}", "application/octet-stream", data)
            parts.append({
                "id": model.name, "mesh": number + k, "colour": colour, "label": not pinch,
                "position": [x, 0.0, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0],
                "top": [x, 0.0, 1.4 * half], "centre": [x, 0.0, 0.0],
                "radius": float(np.hypot(half, model.radius)),
            })  # fmt: skip
        return parts


def _outline(x: float, radius: float, half: float) -> list[float]:
    """Return the outline of the cylinder, seen from the side, as segments."""
    low, high = x - radius, x + radius
    corners = [(low, -half), (high, -half), (high, half), (low, half)]
    ends = zip(corners, corners[1:] + corners[:1], strict=True)
    return [value for a, b in ends for value in (a[0], 0.0, a[1], b[0], 0.0, b[1])]
