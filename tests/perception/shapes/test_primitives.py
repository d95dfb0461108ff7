"""Depths along rays against trimesh's, on the mesh of the same shape; and the fit of each kind."""

import numpy as np
import pytest

from igrip.perception.shapes.primitives import PRIMITIVES, Footprint, Rays

KINDS = PRIMITIVES.names()


def some(kind, random):
    """A shape of a kind, of about the size of things."""
    primitive = PRIMITIVES.get(kind)()
    half = np.sort(random.uniform(0.02, 0.1, 2))[::-1]
    height = random.uniform(0.03, 0.25)
    footprint = Footprint(random.uniform(-0.1, 0.1, 2), random.uniform(-3, 3), half, height)
    start = primitive.start(footprint)
    return primitive, start + primitive.steps * random.normal(size=len(start))


def rays_at(parameters, random, count=150):
    elevation = random.uniform(0.3, 1.5)
    eye = 0.8 * np.array([0.0, -np.cos(elevation), np.sin(elevation)])
    targets = np.append(parameters[:2], 0.08) + random.uniform(-0.12, 0.12, (count, 3))
    return Rays(eye, targets - eye)


@pytest.mark.parametrize("kind", KINDS)
def test_rays_meet_the_mesh_of_the_shape_where_they_meet_the_shape(kind):
    random = np.random.default_rng(0)
    missed, gaps = 0, []
    for _ in range(6):
        primitive, parameters = some(kind, random)
        rays = rays_at(parameters, random)
        mesh = primitive.mesh(parameters)
        mesh.apply_translation(np.append(parameters[:2], 0.0))
        origins = np.tile(rays.origin, (len(rays.directions), 1))
        at, ray, _ = mesh.ray.intersects_location(origins, rays.directions, multiple_hits=True)
        true = np.full(len(origins), np.inf)
        d = rays.directions[ray]
        np.minimum.at(true, ray, ((at - rays.origin) * d).sum(axis=1) / (d * d).sum(axis=1))
        got = primitive.depths(parameters, rays)
        both = np.isfinite(true) & np.isfinite(got)
        missed += int((np.isfinite(true) != np.isfinite(got)).sum())
        gaps += np.abs(true[both] - got[both]).tolist()
    assert missed <= 0.01 * 6 * 150  # facets are inside what is round
    assert len(gaps) > 30
    assert np.quantile(gaps, 0.95) < 0.004


@pytest.mark.parametrize("kind", KINDS)
def test_radii_are_those_of_the_mesh(kind):
    random = np.random.default_rng(1)
    for _ in range(4):
        primitive, parameters = some(kind, random)
        mesh = primitive.mesh(parameters)
        assert mesh.is_watertight
        top = primitive.height(parameters)
        assert mesh.bounds[0, 2] == pytest.approx(0.0, abs=1e-9)
        assert mesh.bounds[1, 2] == pytest.approx(top)
        heights, angles = np.array([0.3, 0.6]) * top, np.linspace(0.0, 6.0, 7)
        radii = primitive.radii(parameters, heights, angles)
        for height, row in zip(heights, radii, strict=True):
            out = np.stack([np.cos(angles), np.sin(angles), np.zeros(7)], axis=1)
            far = out + [0.0, 0.0, height]
            at, ray, _ = mesh.ray.intersects_location(far, -out, multiple_hits=False)
            measured = np.hypot(at[:, 0], at[:, 1])
            np.testing.assert_allclose(measured, row[ray], rtol=0.06)
