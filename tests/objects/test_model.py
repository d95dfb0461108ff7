"""What is derived from a mesh: frame, cylinder, centre, sphere."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from igrip.errors import ObjectsError
from igrip.objects.model import build_model
from oracle.meshes import Mesh, centre_of_gravity, smallest_box
from support import PAPER, mesh_of, random_turn, soup

EXTENTS = {"003_cracker_box": 0.213, "005_tomato_soup_can": 0.102, "006_mustard_bottle": 0.191,
           "021_bleach_cleanser": 0.2525}  # fmt: skip


def turned(mesh, turn, shift=(0.0, 0.0, 0.0)):
    return mesh_of(turn.apply(mesh.vertices) + shift, mesh.faces)


def angle(a, b):
    """Degrees between two lines."""
    return np.degrees(np.arccos(min(1.0, abs(float(a @ b)))))


# the paper's objects -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", PAPER)
def test_frame_of_the_papers_objects(ycb, name):
    model = ycb[name]
    assert abs(model.axis[2]) > 0.99  # they stand, and are longest upright
    assert model.length == pytest.approx(EXTENTS[name], rel=0.01)
    along = model.vertices @ model.axis
    assert model.origin @ model.axis == pytest.approx(0.5 * (along.min() + along.max()))
    assert model.length == pytest.approx(np.ptp(along))
    frame = model.mesh_from_object
    assert frame[:3, :3] @ frame[:3, :3].T == pytest.approx(np.eye(3))
    assert np.linalg.det(frame[:3, :3]) == pytest.approx(1.0)
    assert frame[3].tolist() == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize("name", PAPER)
def test_frame_is_that_of_the_smallest_box(ycb, name):
    """The oracle stands a box on every face of the hull; of a round can, several are as small."""
    model = ycb[name]
    axes, extents = smallest_box(model.vertices)
    longest = int(np.argmax(extents))
    assert angle(model.axis, axes[longest]) < 0.3
    assert model.length == pytest.approx(extents[longest], rel=3e-3)


@pytest.mark.parametrize("name", PAPER)
def test_centre_of_gravity(ycb, name):
    """Two of the four are not watertight: theirs is the centre of the convex hull."""
    model = ycb[name]
    assert model.centre == pytest.approx(centre_of_gravity(model.vertices, model.faces), rel=1e-9)


def test_the_centre_of_a_bottle_lies_below_the_middle(ycb):
    model = ycb["006_mustard_bottle"]
    below = (model.origin - model.centre) @ model.axis
    assert 0.01 < below < 0.02


@pytest.mark.parametrize("name", PAPER)
def test_cylinder_and_sphere_hold_the_mesh(ycb, name):
    model = ycb[name]
    local = (model.vertices - model.origin) @ model.mesh_from_object[:3, :3]
    assert (np.abs(local[:, 2]) <= 0.5 * model.length + 1e-9).all()
    assert np.hypot(local[:, 0], local[:, 1]).max() == pytest.approx(model.radius, rel=1e-6)
    assert np.linalg.norm(model.vertices - model.sphere[:3], axis=1).max() <= model.sphere[3]
    assert model.sphere[3] < 0.6 * np.linalg.norm(np.ptp(model.vertices, axis=0))


@pytest.mark.parametrize("name", PAPER)
@pytest.mark.parametrize("seed", [1, 4])
def test_turning_the_file_turns_the_frame(ycb, name, seed):
    """The frame belongs to the shape, not to how it lies in its file."""
    model = ycb[name]
    turn, shift = random_turn(np.random.default_rng(seed)), np.array([0.3, -0.2, 0.1])
    mesh = mesh_of(model.vertices, model.faces)
    other = build_model(name, turned(mesh, turn, shift))
    assert other.centre == pytest.approx(turn.apply(model.centre) + shift, abs=1e-9)
    assert other.length == pytest.approx(model.length, rel=1e-3)
    assert other.radius == pytest.approx(model.radius, rel=5e-3)
    assert angle(other.axis, turn.apply(model.axis)) < 0.3
    assert other.origin == pytest.approx(turn.apply(model.origin) + shift, abs=1e-3)


# simple shapes -----------------------------------------------------------------------------------


@given(st.integers(0, 10_000))
def test_a_box_anywhere(seed):
    rng = np.random.default_rng(seed)
    size = np.sort(rng.uniform(0.02, 0.3, 3)) * [1.0, 1.05, 1.1]  # no two edges alike
    turn, shift = random_turn(rng), rng.uniform(-1.0, 1.0, 3)
    model = build_model("box", turned(trimesh.creation.box(size), turn, shift))
    assert angle(model.axis, turn.apply([0.0, 0.0, 1.0])) < 1e-4
    assert model.length == pytest.approx(size[2], rel=1e-6)
    assert model.radius == pytest.approx(0.5 * np.hypot(size[0], size[1]), rel=1e-6)
    assert model.origin == pytest.approx(shift, abs=1e-7)
    assert model.centre == pytest.approx(shift, abs=1e-9)


@given(st.integers(0, 10_000))
def test_a_rod_anywhere(seed):
    rng = np.random.default_rng(seed)
    radius, length = rng.uniform(0.01, 0.04), rng.uniform(0.1, 0.3)
    turn, shift = random_turn(rng), rng.uniform(-1.0, 1.0, 3)
    rod = trimesh.creation.cylinder(radius, length, sections=24)
    model = build_model("rod", turned(rod, turn, shift))
    assert angle(model.axis, turn.apply([0.0, 0.0, 1.0])) < 0.5
    assert model.length == pytest.approx(length, rel=5e-3)
    assert model.radius == pytest.approx(radius, rel=5e-3)
    assert model.origin == pytest.approx(shift, abs=1e-3)


def test_a_cube_stands_as_its_file_does():
    model = build_model("cube", trimesh.creation.box((0.05, 0.0502, 0.0501)))
    assert model.axis == pytest.approx([0.0, 0.0, 1.0])
    assert model.length == pytest.approx(0.0501)


def test_the_axis_points_along_the_last_of_its_components():
    for turn in ([0, 0, 0], [np.pi, 0, 0], [0, 0.4, 0], [2.8, 0, 0]):
        mesh = turned(trimesh.creation.box((0.05, 0.06, 0.2)), Rotation.from_rotvec(turn))
        assert build_model("box", mesh).axis[2] > 0.0
    lying = trimesh.creation.box((0.2, 0.06, 0.05))
    assert build_model("box", lying).axis == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, -3.0, 0.0), (1.0, 1.0, 0.0)])
def test_an_axis_that_is_given(axis):
    mesh = turned(trimesh.creation.box((0.1, 0.2, 0.3)), Rotation.identity(), (1.0, 2.0, 3.0))
    model = build_model("box", mesh, axis=np.array(axis))
    unit = np.array(axis) / np.linalg.norm(axis)
    assert model.axis == pytest.approx(unit)
    assert model.length == pytest.approx(np.abs(unit) @ [0.1, 0.2, 0.3])
    assert model.origin == pytest.approx([1.0, 2.0, 3.0])


def test_an_open_mesh_takes_the_centre_of_its_hull():
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    full = build_model("full", box)
    lidless = build_model("open", mesh_of(box.vertices, box.faces[2:]))
    assert not mesh_of(box.vertices, box.faces[2:]).is_watertight
    assert lidless.centre == pytest.approx(full.centre, abs=1e-12)
    assert lidless.length == pytest.approx(full.length)


def test_a_mesh_inside_out_has_the_same_centre():
    bottle = trimesh.creation.cone(0.05, 0.2)
    right = build_model("cone", bottle)
    inverted = build_model("cone", mesh_of(bottle.vertices, bottle.faces[:, ::-1]))
    assert inverted.centre == pytest.approx(right.centre, abs=1e-9)
    assert inverted.centre[2] == pytest.approx(0.05, abs=1e-3)


def test_vertices_without_a_face_do_not_count():
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    far = np.vstack([box.vertices, [[5.0, 5.0, 5.0]]])
    model = build_model("box", mesh_of(far, box.faces))
    assert model.length == pytest.approx(0.3)
    assert model.sphere[:3] == pytest.approx(np.zeros(3))


def test_degenerate_faces_are_left_out():
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    faces = np.vstack([box.faces, [[0, 0, 1], [2, 2, 2]]])
    model = build_model("box", mesh_of(box.vertices, faces))
    assert len(model.faces) == 12
    assert len(model.bvh.leaves) == 12


def test_a_flat_mesh():
    sheet = mesh_of([[0, 0, 0.2], [0.3, 0, 0.2], [0.3, 0.1, 0.2], [0, 0.1, 0.2]],
                    [[0, 1, 2], [0, 2, 3]])  # fmt: skip
    model = build_model("sheet", sheet)
    assert model.axis == pytest.approx([1.0, 0.0, 0.0])
    assert model.length == pytest.approx(0.3)
    assert model.origin == pytest.approx([0.15, 0.05, 0.2])
    assert model.centre == pytest.approx([0.15, 0.05, 0.2])


def test_one_triangle():
    model = build_model("scrap", mesh_of([[0, 0, 0], [0.2, 0, 0], [0, 0.01, 0]], [[0, 1, 2]]))
    assert np.isfinite(model.mesh_from_object).all()
    assert model.length == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize(
    ("vertices", "faces", "word"),
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.empty((0, 3), dtype=int), "no faces"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "degenerate"),
        ([[0, 0, 0], [1, 0, 0], [np.nan, 1, 0]], [[0, 1, 2]], "finite"),
    ],
)
def test_a_mesh_without_surface(vertices, faces, word):
    with pytest.raises(ObjectsError, match=word):
        build_model("nothing", mesh_of(vertices, faces))


@given(st.integers(0, 10_000))
def test_any_heap_of_triangles_has_a_model(seed):
    vertices, faces = soup(np.random.default_rng(seed), 12)
    model = build_model("heap", mesh_of(vertices, faces))
    oracle = Mesh(vertices, faces, axis=model.axis)
    assert model.length == pytest.approx(oracle.length)
    assert model.centre == pytest.approx(oracle.centre, abs=1e-9)
    assert model.sphere[:3] == pytest.approx(oracle.middle)
    local = (vertices - model.origin) @ model.mesh_from_object[:3, :3]
    assert np.hypot(local[:, 0], local[:, 1]).max() <= model.radius * (1 + 1e-9)


def test_it_is_immutable(ycb):
    with pytest.raises(dataclasses.FrozenInstanceError):
        ycb[PAPER[0]].length = 3.0
