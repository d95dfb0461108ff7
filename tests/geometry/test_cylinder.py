"""The cylinders of a frame, against the models' own numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.geometry import cylinder
from igrip.geometry.scene import PlacedObject, RayConfig, Scene
from support import BOX, CAN


def test_cylinders_are_those_of_the_models_in_the_world(shapes, at_rest):
    rng = np.random.default_rng(0)
    placed = []
    for k, name in enumerate((BOX, CAN, BOX)):
        turn = Rotation.random(random_state=k).as_matrix()
        placed.append(
            PlacedObject(
                str(k),
                shapes[name],
                turn,
                rng.normal(size=3),
                rng.normal(size=3),
                rng.normal(size=3),
            )
        )
    [geometry] = Scene(RayConfig()).measure([at_rest], placed)
    rows = geometry.cylinders()
    assert rows.shape == (3, cylinder.WIDTH)
    for row, one in zip(rows, placed, strict=True):
        assert row[:3] == pytest.approx(one.rotation @ one.model.origin + one.translation)
        assert row[3:6] == pytest.approx(one.rotation @ one.model.axis)
        assert row[cylinder.HALF_LENGTH] == 0.5 * one.model.length
        assert row[cylinder.RADIUS] == one.model.radius
        assert row[cylinder.VELOCITY :] == pytest.approx(one.velocity)


def test_nothing_has_no_cylinders(at_rest):
    [geometry] = Scene(RayConfig()).measure([at_rest], [])
    assert geometry.cylinders().shape == (0, cylinder.WIDTH)


@pytest.fixture
def at_rest():
    from frames import motion

    still = motion()
    return still._replace(future=np.zeros((10, 3)), future_velocity=np.zeros((10, 3)))
