"""The cylinders of a frame, against the models' own numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.geometry.cylinder import Cylinders, axis_of, centre_of, size_of, velocity_of
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
    cylinders = geometry.cylinders()
    assert len(cylinders.radius) == 3
    for k, one in enumerate(placed):
        assert cylinders.centre[k] == pytest.approx(
            one.rotation @ one.model.origin + one.translation
        )
        assert cylinders.axis[k] == pytest.approx(one.rotation @ one.model.axis)
        assert cylinders.half_length[k] == 0.5 * one.model.length
        assert cylinders.radius[k] == one.model.radius
        assert cylinders.velocity[k] == pytest.approx(one.velocity)


def test_nothing_has_no_cylinders(at_rest):
    [geometry] = Scene(RayConfig()).measure([at_rest], [])
    assert len(geometry.cylinders().radius) == 0


@pytest.mark.parametrize("o", [0, 1])
def test_rows_and_properties_are_what_was_put_in(o):
    rng = np.random.default_rng(1)
    parts = (
        rng.normal(size=(2, 3)), rng.normal(size=(2, 3)), rng.random(2), rng.random(2),
        rng.normal(size=(2, 3)),
    )  # fmt: skip
    cylinders = Cylinders.of(*parts)
    centre, axis, half_length, radius, velocity = parts
    properties = (
        cylinders.centre, cylinders.axis, cylinders.half_length, cylinders.radius,
        cylinders.velocity,
    )  # fmt: skip
    for found, put in zip(properties, parts, strict=True):
        assert found.tolist() == put.tolist()
    row = cylinders.rows[o]
    assert centre_of(row).tolist() == centre[o].tolist()
    assert axis_of(row).tolist() == axis[o].tolist()
    assert velocity_of(row).tolist() == velocity[o].tolist()
    assert size_of(row) == (half_length[o], radius[o])
    assert cylinders.one(o).rows.tolist() == [row.tolist()]


@pytest.fixture
def at_rest():
    from frames import motion

    still = motion()
    return still._replace(future=np.zeros((10, 3)), future_velocity=np.zeros((10, 3)))


def test_distance_from_a_cylinder():
    """Beside, beyond and inside a cylinder of radius 3 cm and half-length 10 cm along x."""
    one = Cylinders.of(
        np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]]), np.array([0.1]), np.array([0.03]),
        np.zeros((1, 3)),
    )  # fmt: skip
    cases = [
        ([0.05, 0.0, 0.08], 0.05), ([0.16, 0.0, 0.01], 0.06), ([0.13, 0.07, 0.0], 0.05),
        ([0.05, 0.01, 0.01], 0.0),
    ]  # fmt: skip
    for point, distance in cases:
        assert one.distance(0, np.array(point)) == pytest.approx(distance)
    assert one.one(0).rows.tolist() == one.rows.tolist()
