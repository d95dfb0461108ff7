"""Sampled surfaces: points and normals of a ball and a wall, however their meshes are."""

from __future__ import annotations

import numpy as np
import pytest
from trimesh import creation

from igrip.grasps.surface import sample_surface

RADIUS = 0.04
BALL = creation.icosphere(5, RADIUS)


@pytest.mark.parametrize("inwards", [False, True])
def test_points_lie_on_a_ball_with_normals_outwards(inwards):
    faces = BALL.faces[:, ::-1] if inwards else BALL.faces
    surface = sample_surface(BALL.vertices, faces)
    away = np.linalg.norm(surface.points, axis=1)
    assert away == pytest.approx(RADIUS, abs=5e-4)
    assert (np.einsum("ni,ni->n", surface.normals, surface.points) / away).min() > 0.99


def test_noise_of_the_vertices_is_averaged_away():
    noise = np.random.default_rng(0).normal(0.0, 0.002 / np.sqrt(3.0), BALL.vertices.shape)
    surface = sample_surface(BALL.vertices + noise, BALL.faces)
    away = np.linalg.norm(surface.points, axis=1)
    cosine = np.einsum("ni,ni->n", surface.normals, surface.points) / away
    assert np.std(away) < 0.001  # of 2 mm
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean() < 12.0


def test_both_sides_of_a_thin_wall_keep_their_normals():
    wall = creation.box([0.1, 0.1, 0.003]).subdivide_to_size(0.004)
    surface = sample_surface(wall.vertices, wall.faces)
    inner = np.abs(surface.points[:, :2]).max(axis=1) < 0.04
    side = np.sign(surface.points[inner, 2])
    assert (side * surface.normals[inner, 2]).min() > 0.95


def test_a_mesh_of_a_few_faces_is_divided():
    box = creation.box([0.07, 0.16, 0.21])
    assert len(sample_surface(box.vertices, box.faces).points) > 1000
