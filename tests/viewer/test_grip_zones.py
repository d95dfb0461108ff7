"""Grip zones on the surface: cut where the rule changes, and nothing lost."""

import numpy as np
import pytest
import trimesh

from igrip.objects.model import build_model
from igrip.viewer.grip_zones import grip_zones
from support import PAPER


def areas(vertices, faces):
    corners = vertices[faces]
    return 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )


def test_a_box_of_twelve_triangles():
    model = build_model("box", trimesh.creation.box((0.06, 0.08, 0.20)))
    zones = grip_zones(model, 0.85)
    size = areas(zones.vertices, zones.faces)
    sides, ends = 2 * (0.06 + 0.08) * 0.20, 2 * 0.06 * 0.08
    assert size.sum() == pytest.approx(sides + ends)
    assert size[zones.pinch].sum() == pytest.approx(0.15 * sides + ends)


@pytest.mark.parametrize("name", PAPER)
def test_real_meshes(ycb, name):
    model = ycb[name]
    zones = grip_zones(model, 0.85)
    whole = areas(model.vertices, model.faces).sum()
    assert areas(zones.vertices, zones.faces).sum() == pytest.approx(whole, rel=1e-6)
    heights = np.abs(zones.vertices[zones.faces][:, :, 2])
    border = 0.85 * 0.5 * model.length
    assert (heights[zones.pinch] >= border - 1e-7).all()
    assert (heights[~zones.pinch] <= border + 1e-7).all()
