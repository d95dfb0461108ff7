import numpy as np
import pytest
import trimesh

from igrip.objects.model import build_model
from igrip.perception.registration.distinct_starts import TURNS, distinct_starts
from igrip.perception.registration.shape import derive_shape


def distinct(shape):
    surface = shape.surface
    return distinct_starts(surface.points, surface.centre, surface.field, shape.stable_poses)


def starts_of(mesh):
    shape = derive_shape(build_model("it", mesh))
    return distinct(shape), shape


def test_a_cylinder_stands_in_one_way_and_lies_in_six():
    mesh = trimesh.creation.cylinder(radius=0.034, height=0.10, sections=96)
    starts, _ = starts_of(mesh)
    assert len(starts) == 1 + len(TURNS) // 2  # half a turn of a lying cylinder is none


def test_a_ball_has_one_start():
    starts, _ = starts_of(trimesh.creation.icosphere(subdivisions=4, radius=0.04))
    assert len(starts) == 1


def test_a_box_looks_alike_after_half_a_turn():
    starts, shape = starts_of(trimesh.creation.box((0.05, 0.09, 0.14)))
    assert (starts[:, 0] == 0).sum() == len(TURNS) // 2
    assert len(starts) <= len(shape.starts) / 2


@pytest.mark.parametrize("name", ["003_cracker_box", "006_mustard_bottle", "025_mug"])
def test_every_start_left_out_is_one_that_is_kept(ycb, name):
    shape = derive_shape(ycb[name])
    kept = distinct(shape)
    centre = shape.surface.centre
    tree = shape.surface.points - centre

    def placed(way, turn):
        c, s = np.cos(TURNS[turn]), np.sin(TURNS[turn])
        rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ shape.stable_poses.rotations[way]
        height = shape.stable_poses.heights[way] + shape.stable_poses.rotations[way][2] @ centre
        return tree @ rotation.T + [0, 0, height]

    clouds = [placed(*start) for start in kept]
    for way, turn in shape.starts:
        if any((kept == [way, turn]).all(axis=1)):
            continue
        own = placed(way, turn)
        gaps = [
            np.median(np.linalg.norm(own[:, None] - cloud, axis=2).min(axis=1)) for cloud in clouds
        ]
        assert min(gaps) < 0.008  # about as far as the points are apart
