"""The table before a camera: the level plane over a floor, kept from frame to frame."""

from dataclasses import replace

import numpy as np
import pytest

from igrip.lab.rendering.scene import RenderConfig, RenderedScene
from igrip.perception.registration.table import Table
from standing import CAMERA

REACH = (0.2, 3.0)


def scene(width):
    """A table so wide, 0.73 m over an endless floor."""
    return RenderedScene({}, CAMERA, config=RenderConfig(table_width=width, table_depth=0.5))


@pytest.mark.parametrize("width", [1.4, 0.45])
def test_the_table_is_found_though_the_floor_is_larger(width):
    table, random = Table(), np.random.default_rng(0)
    frame = scene(width).frame(0.0, random)
    assert table.update(frame, REACH, random, False)
    assert table.change is not None
    up = table.world_from_table[:3, 2]
    assert up @ [0.0, 0.0, 1.0] > np.cos(np.radians(2.0))
    assert abs(table.world_from_table[2, 3]) < 0.01


def test_it_is_kept_while_it_is_there():
    table, random = Table(), np.random.default_rng(0)
    for k in range(3):
        assert table.update(scene(1.4).frame(0.1 * k, random), REACH, random, False)
        assert (table.change is None) == (k > 0)


def test_without_any_plane_there_is_none():
    table, random = Table(), np.random.default_rng(0)
    frame = scene(1.4).frame(0.0, random)
    noise = random.uniform(0.3, 2.9, frame.depth.shape).astype(np.float32)
    assert not table.update(replace(frame, depth=noise), REACH, random, False)
