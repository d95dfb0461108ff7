"""The oracle against numbers that were worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from oracle import cones, filters, meshes, motion, scores, trials

CUBE = trimesh.creation.box((2.0, 2.0, 2.0))


def test_one_euro_step_by_hand():
    # cutoff 1/(2 pi) Hz has tau = 1 s: with dt = 1 s every weight is 1/2, beta = 0
    tau_1 = 1.0 / (2.0 * np.pi)
    out, slope, velocity = filters.one_euro_points(
        [0.0, 1.0, 2.0], [[0, 0, 0], [4, 0, 0], [4, 0, 0]],
        min_cutoff=tau_1, beta=0.0, derivative_cutoff=tau_1,
    )  # fmt: skip
    assert out[:, 0].tolist() == pytest.approx([0.0, 2.0, 3.0])
    assert slope[:, 0].tolist() == pytest.approx([0.0, 2.0, 2.0])  # the last: (2 + (4-2)) / 2
    assert velocity[:, 0].tolist() == pytest.approx([0.0, 1.0, 1.0])  # of 0, 2, 3


def test_speed_is_the_norm_of_the_derivative():
    along = filters.one_euro_points(
        [0, 0.1, 0.2], [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]],
        min_cutoff=1.0, beta=1.0, derivative_cutoff=1.0,
    )[0]  # fmt: skip
    turn = Rotation.from_rotvec([0.3, 0.4, 0.5])
    turned = filters.one_euro_points(
        [0, 0.1, 0.2], turn.apply([[0, 0, 0], [0.5, 0, 0], [1, 0, 0]]),
        min_cutoff=1.0, beta=1.0, derivative_cutoff=1.0,
    )[0]  # fmt: skip
    assert turn.apply(along) == pytest.approx(turned)


def test_rotations_about_one_axis_are_filtered_like_numbers():
    angles = np.array([0.0, 0.3, 0.5, 0.4])
    options = {"min_cutoff": 1.0, "beta": 2.0, "derivative_cutoff": 0.5}
    times = [0.0, 0.1, 0.25, 0.3]
    turned, w, spin = filters.one_euro_rotations(
        times, Rotation.from_rotvec(angles[:, None] * [0, 0, 1]).as_quat(), **options
    )
    moved, v, speed = filters.one_euro_points(times, angles[:, None] * [0, 0, 1], **options)
    assert turned.as_rotvec() == pytest.approx(moved)
    assert w == pytest.approx(v)
    assert spin == pytest.approx(speed)


def test_fit_recovers_a_parabola_and_weighs_residuals():
    times = np.array([10.0, 10.1, 10.3, 10.4])
    s = times - 10.4
    positions = np.stack([1 + 2 * s + 3 * s**2, -s, 0 * s + 5], axis=1)
    assert motion.fit(times, positions) == pytest.approx(
        np.array([[1, 0, 5], [2, -1, 0], [3, 0, 0]]), abs=1e-12
    )
    # four samples, one free residual direction: the least Σ w r² has r_k ∝ n_k / w_k
    bumped = positions + np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 0]])
    c = motion.fit(times, bumped)
    residual = bumped[:, 0] - (c[0, 0] + c[1, 0] * s + c[2, 0] * s**2)
    w = 1.0 / (1.0 - s)
    assert np.array([w, w * s, w * s**2]) @ residual == pytest.approx(0.0, abs=1e-12)


def test_future_points_by_hand():
    c = np.array([[1.0, 0, 0], [2.0, 0, 0], [3.0, 0, 0]])
    points, velocities = motion.future(c, 2, 1.0)
    assert points[:, 0].tolist() == [1 + 1 + 0.75, 1 + 2 + 3]
    assert velocities[:, 0].tolist() == [2 + 3, 2 + 6]


def test_window_is_bounded_by_count_and_time():
    times = [0.0, 0.1, 0.2, 5.0, 5.1]
    assert motion.window_of(times, 2, 2, 1.0) == [1, 2]
    assert motion.window_of(times, 4, 20, 1.0) == [3, 4]


@pytest.mark.parametrize(
    ("point", "surface", "vertex"),
    [
        ((0, 0, 3), 2.0, np.sqrt(6)),  # above a face
        ((2, 2, 0), np.sqrt(2), np.sqrt(3)),  # beside an edge
        ((3, 3, 3), np.sqrt(12), np.sqrt(12)),  # off a corner
        ((0, 0, 0.5), 0.5, np.sqrt(2.25)),  # inside
    ],
)
def test_nearest_points_of_a_cube(point, surface, vertex):
    mesh = meshes.Mesh(CUBE.vertices, CUBE.faces)
    assert meshes.nearest_surface(mesh.corners, np.array(point))[0] == pytest.approx(surface)
    assert meshes.nearest_vertex(mesh, np.array(point, dtype=float)) == pytest.approx(vertex)


def test_rays_and_a_cube():
    rays = np.array([[0, 0, -1], [0, 0, 1], [0.3, 0.1, -1], [1, 0, 0], [0, 0, -2]], dtype=float)
    origin = np.array([0.1, 0.2, 3.0])
    margins = meshes.ray_margins(CUBE.triangles, origin, rays)
    assert (margins >= 0).tolist() == [True, False, True, False, True]
    lengths = meshes.ray_lengths(CUBE.triangles, origin, rays)
    assert lengths.tolist() == pytest.approx([2.0, np.inf, 2.0, np.inf, 1.0])


def test_rays_that_pass_by_the_whole_mesh_are_misses():
    mesh = meshes.Mesh(CUBE.vertices, CUBE.faces)
    rng = np.random.default_rng(1)
    for _ in range(20):
        apex, rays = rng.normal(0.0, 3.0, 3), rng.normal(size=(40, 3))
        every = meshes.ray_margins(mesh.corners, apex, rays)
        assert ((meshes.cone_margins(mesh, apex, rays) >= 0.0) == (every >= 0.0)).all()


def test_frame_and_centre_of_a_turned_box():
    turn = Rotation.from_rotvec([0.4, -0.2, 0.9])
    box = trimesh.creation.box((0.1, 0.2, 0.5))
    mesh = meshes.Mesh(turn.apply(box.vertices) + [1.0, 2.0, 3.0], box.faces)
    assert abs(mesh.axis @ turn.apply([0, 0, 1])) == pytest.approx(1.0)
    assert mesh.length == pytest.approx(0.5)
    assert mesh.centre == pytest.approx([1.0, 2.0, 3.0])
    assert abs(mesh.axial(np.array([1.0, 2.0, 3.0]) + turn.apply([0.3, 0.1, 0.2]))) == (
        pytest.approx(0.2)
    )


def test_centre_of_an_open_mesh_is_that_of_its_hull():
    open_cube = CUBE.faces[2:]
    assert not meshes.is_closed(open_cube)
    assert meshes.is_closed(CUBE.faces)
    assert meshes.centre_of_gravity(CUBE.vertices, open_cube) == pytest.approx(np.zeros(3))


def test_cone_stays_inside_its_half_angle():
    axis = np.array([0.0, 0.0, 0.5])
    rays = cones.directions(np.zeros(3), axis, np.array([1.0, 0, 1.0]), ())
    angles = np.degrees(np.arccos(rays[:, 2] / np.linalg.norm(rays, axis=1)))
    half = 25.0 + (0.5 - 0.03) / (0.8 - 0.03) * (8.0 - 25.0)
    assert len(rays) == 36
    assert angles[0] == 0.0
    assert angles.max() == pytest.approx(half)
    assert rays[1, 0] > 0.0  # the first ray off the axis leans towards the object
    assert rays[1, 1] == pytest.approx(0.0)


def test_scores_by_hand():
    assert scores.impacts([3, 1, 0]).tolist() == [0.75, 0.25, 0.0]
    assert scores.impacts([0, 0]).tolist() == [0.0, 0.0]
    assert scores.distance_derivative([-0.2, 0.1], 0.4).tolist() == [0.5, -0.25]
    assert scores.distance_derivative([-0.02], 0.02).tolist() == [0.0]
    assert scores.closeness([0.5, 3.0], [[0, 0, 0], [0, 0, 2.0]]).tolist() == [0.75, 0.0]
    assert scores.closeness([0.25], [[0, 0, 0]]).tolist() == [0.5]
    assert scores.weights("paper", 2.0, 1.0) == (1.0, 2.0)
    assert scores.weights("paper", 1.0, 2.0) == (0.5, 1.0)
    assert scores.weights("repaired", 1.0, 2.0) == (1.0, 0.5)
    assert scores.weights("repaired", 9.0, 2.0) == (1.0, 2.0)
    assert scores.weights("repaired", 9.0, None) == (1.0, 1.0)
    assert [scores.target(s) for s in ([0.1, 0.2], [0.2, 0.2], [0.0, -1.0], [])] == [
        1, None, None, None,
    ]  # fmt: skip
    assert scores.grip(0.085, 0.2) == "pinch"
    assert scores.grip(-0.0849, 0.2) == "palmar"


def test_trial_by_hand():
    times = [0.1 * k for k in range(11)]
    speeds = [0, 0.05, 0.2, 0.6, 1.0, 0.8, 0.3, 0.12, 0.1, 0.1, 0.1]
    onset, end = trials.onset_and_end(times, speeds)
    assert onset == pytest.approx(0.2)
    assert end == pytest.approx(0.7)  # first below 0.1 + 0.1 * (1.0 - 0.1) = 0.19
    correct = [True, True, False, True, True, True, False, True, True, True, True]
    result = trials.trial(times, correct, onset, end)
    assert result["ratio"] == pytest.approx(0.8)  # frames 3..7, one wrong
    assert result["success"]
    assert result["delay"] == pytest.approx(0.1)
    assert result["margin"] == pytest.approx(0.4)
    assert trials.k_target([True, True, False, True, True], 4) == 0  # tied: the earliest
    assert trials.trial(times, [False] * 11, onset, end)["success"] is False
