"""A figure of the grip zones of objects (paper: Figure 2)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from igrip.lab.report.matplotlib_figure import new_figure
from igrip.objects.model import ObjectModel
from igrip.viewer.grip_zones import PALMAR, PINCH, grip_zones

PALMAR_HEX, PINCH_HEX = ("#{:02x}{:02x}{:02x}".format(*colour) for colour in (PALMAR, PINCH))


def draw_grip_zones(models: Sequence[ObjectModel], pinch_from: float, path: Path) -> None:
    """Draw each object from the side, to one scale: its zones, its cylinder and its z axis.

    ``pinch_from`` is the border of the pinch zone, in half-lengths of the cylinder; the ending of
    the file selects PNG or SVG. Raises :class:`MissingExtraError` without matplotlib.
    """
    figure = new_figure(max(5.2, 2.6 * len(models)), 4.6, "the picture of grip zones")
    panels = figure.subplots(1, len(models), sharey=True, squeeze=False)[0]
    width = max(110.0, *(1100.0 * model.radius for model in models))  # mm, as the heights
    height = max(180.0, *(700.0 * model.length for model in models))
    for panel, model in zip(panels, models, strict=True):
        _draw(panel, model, pinch_from)
        panel.set_xlim(-width, width)
        panel.set_ylim(-height, height)
    panels[0].set_ylabel("z in the object's frame [mm]")
    figure.suptitle("grip by height: palmar (blue), pinch (magenta and beyond)", fontsize=10)
    figure.savefig(path, dpi=150)


def _draw(panel: Any, model: ObjectModel, pinch_from: float) -> None:
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Rectangle

    zones = grip_zones(model, pinch_from)
    corners = 1e3 * zones.vertices[zones.faces]  # millimetres
    order = np.argsort(-corners[:, :, 1].mean(axis=1))  # the far side first
    half, radius = 500.0 * model.length, 1e3 * model.radius
    colours = np.where(zones.pinch, PINCH_HEX, PALMAR_HEX)[order]
    panel.add_collection(
        PolyCollection(list(corners[order][:, :, [0, 2]]), facecolors=colours, edgecolors="none")
    )
    panel.add_patch(
        Rectangle((-radius, -half), 2 * radius, 2 * half, facecolor="#80808028", edgecolor="grey")
    )
    border = pinch_from * half
    for height in (-border, border):
        panel.axhline(height, color=PINCH_HEX, linewidth=0.8, linestyle="--")
    panel.annotate(
        "", (0.0, 1.35 * half), (0.0, 0.0),
        arrowprops={"arrowstyle": "-|>", "color": "#d02020", "linewidth": 1.5},
    )  # fmt: skip
    panel.set_title(f"{model.name}\nborder ±{border:.1f} mm", fontsize=8)
    panel.set_aspect("equal")
