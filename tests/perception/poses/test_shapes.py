"""The pose estimator ``shapes`` on rendered things, whose meshes it does not know."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import igrip
from igrip.errors import IgripError
from igrip.lab.rendering.drawn_hand import draw_hand, paste_hand
from igrip.lab.rendering.layout import look_at
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.model import build_model
from igrip.perception.poses.shapes import ShapesPoses
from overlaid_scene import Overlay, overlaid
from rgbd_frames import frame as plain_frame
from standing import CAMERA, standing

EVERY = 0.1  # s


def solid(name, mesh):
    return build_model(name, mesh)


BOX = solid("plain box", trimesh.creation.box((0.14, 0.06, 0.18)))
CAN = solid("plain can", trimesh.creation.cylinder(0.035, 0.11, sections=64))
BALL = solid("plain ball", trimesh.creation.icosphere(subdivisions=4, radius=0.04))


@pytest.fixture
def catalog():
    """Knows nothing that is on the table; models of things are put into it."""
    return igrip.load_objects("box:0.01x0.02x0.03")


def film(estimator, scene, count, start=0.0, overlays=(), hands=(), seed=0):
    scene = overlaid(scene, overlays)
    random = np.random.default_rng(seed)
    poses = {}
    for k in range(count):
        poses = estimator.estimate(scene.frame(start + EVERY * k, random), hands)
    return poses


def vertices_of(model, pose):
    return model.vertices @ Rotation.from_quat(pose.orientation).as_matrix().T + pose.position


def nearest(catalog, poses, placed):
    """The id, in the poses, of what is nearest to a placed mesh, and its vertices."""
    true = placed.model.vertices @ placed.pose[:3, :3].T + placed.pose[:3, 3]
    middle = 0.5 * (true.min(axis=0) + true.max(axis=0))
    found = {id: vertices_of(catalog[id], pose) for id, pose in poses.items() if pose is not None}
    middles = {id: 0.5 * (v.min(axis=0) + v.max(axis=0)) for id, v in found.items()}
    id = min(found, key=lambda id: np.linalg.norm(middles[id] - middle))
    return id, found[id], true


def sizes(vertices):
    return np.sort(trimesh.bounds.oriented_bounds(trimesh.convex.convex_hull(vertices))[1])


def centre(vertices):
    return trimesh.convex.convex_hull(vertices).center_mass


def check(catalog, poses, placed, size=0.1, gap=0.01):
    id, got, true = nearest(catalog, poses, placed)
    np.testing.assert_allclose(sizes(got), sizes(true), rtol=size)
    assert np.linalg.norm(centre(got) - centre(true)) < gap
    return id


def up_of(catalog, pose):
    axis = Rotation.from_quat(pose.orientation).as_matrix() @ catalog[pose.model].axis
    return np.degrees(np.arccos(min(1.0, abs(axis[2]))))


def test_simple_things_are_measured(catalog):
    scene = RenderedScene(
        {"box": standing(BOX, -0.2, 0.0), "can": standing(CAN, 0.03, 0.05),
         "ball": standing(BALL, 0.17, -0.06)}, CAMERA,
    )  # fmt: skip
    poses = film(ShapesPoses(catalog), scene, 8)
    assert set(poses) == {"object_1", "object_2", "object_3"}
    ids = {name: check(catalog, poses, placed) for name, placed in scene.objects.items()}
    assert len(set(ids.values())) == 3
    assert up_of(catalog, poses[ids["box"]]) < 10.0
    assert up_of(catalog, poses[ids["can"]]) < 10.0
    assert catalog[ids["can"]].symmetry == "cylinder"
    for id, pose in poses.items():
        assert pose.model == id
        assert pose.source == "shapes"
        assert pose.t == pytest.approx(0.7)
        assert 0.0 < pose.std < 0.02


@pytest.mark.slow
def test_a_mug_a_bowl_and_fruit_are_measured(ycb, catalog):
    scene = RenderedScene(
        {"bowl": standing(ycb["024_bowl"], -0.17, 0.05),
         "mug": standing(ycb["025_mug"], 0.05, 0.06, yaw=2.4),
         "orange": standing(ycb["017_orange"], 0.18, -0.08)}, CAMERA,
    )  # fmt: skip
    poses = film(ShapesPoses(catalog), scene, 8)
    assert len(poses) == 3
    bowl = check(catalog, poses, scene.objects["bowl"])
    check(catalog, poses, scene.objects["orange"])
    mug, got, true = nearest(catalog, poses, scene.objects["mug"])
    assert np.ptp(got[:, 2]) == pytest.approx(np.ptp(true[:, 2]), rel=0.1)
    assert np.linalg.norm(centre(got) - centre(true)) < 0.015  # its handle may be hidden
    assert up_of(catalog, poses[bowl]) < 10.0
    assert up_of(catalog, poses[mug]) < 10.0


def arm_over(scene, placed, size=0.32):
    """Something between the camera and an object."""
    middle = placed.pose[:3, :3] @ placed.model.sphere[:3] + placed.pose[:3, 3]
    local = np.linalg.inv(scene.world_from_camera) @ [*middle, 1.0]
    u, v = scene.intrinsics.pixels(local[None, :3])[0]
    w = int(size * scene.intrinsics.fx / local[2])
    colour = np.full((w, w, 3), 180, dtype=np.uint8)
    depth = np.full((w, w), local[2] - 0.2)
    return Overlay(colour, np.ones((w, w), dtype=bool), depth, int(u - w / 2), int(v - w / 2))


def test_ids_are_kept_while_hidden_taken_away_and_put_elsewhere(catalog):
    scene = RenderedScene(
        {"box": standing(BOX, -0.15, 0.0), "can": standing(CAN, 0.12, 0.0)}, CAMERA
    )
    estimator = ShapesPoses(catalog)
    before = film(estimator, scene, 6)
    box, *_ = nearest(catalog, before, scene.objects["box"])
    can, *_ = nearest(catalog, before, scene.objects["can"])
    arm = arm_over(scene, scene.objects["box"])
    during = film(estimator, scene, 6, start=1.0, overlays=[arm])
    assert during[box].t == before[box].t
    assert set(during) == {box, can}  # what hides it is no thing
    after = film(estimator, scene, 3, start=2.0)
    assert after[box].t > 2.0
    without = RenderedScene({"can": scene.objects["can"]}, CAMERA)
    gone = film(estimator, without, 5, start=3.0)
    assert gone[box] is None
    assert gone[can] is not None
    elsewhere = RenderedScene(
        {**without.objects, "box": standing(BOX, -0.1, 0.12, yaw=1.2)}, CAMERA
    )
    back = film(estimator, elsewhere, 8, start=4.0)
    assert back[box] is not None
    check(catalog, back, elsewhere.objects["box"], gap=0.015)
    assert set(back) == {box, can}


def test_a_hand_and_an_arm_are_no_things(catalog):
    scene = RenderedScene({"can": standing(CAN, 0.12, 0.05)}, CAMERA)
    estimator = ShapesPoses(catalog)
    random = np.random.default_rng(0)
    sprite = draw_hand()
    for k in range(12):  # in the first frames nobody tells that it is one
        frame, landmarks = paste_hand(scene.frame(EVERY * k, random), sprite, (150.0, 250.0), 0.62)
        poses = estimator.estimate(frame, [landmarks] if k > 2 else [])
    assert len([pose for pose in poses.values() if pose is not None]) == 1
    check(catalog, poses, scene.objects["can"])


def test_an_arm_that_nobody_detects_is_no_thing(catalog):
    scene = RenderedScene({"can": standing(CAN, 0.12, 0.05)}, CAMERA)
    width, length = 45, 200  # from the lower edge of the picture, some centimetres over the table
    depth = np.repeat(np.linspace(0.64, 0.42, length)[:, None], width, axis=1)
    arm = Overlay(
        np.full((length, width, 3), 190, dtype=np.uint8), np.ones((length, width), dtype=bool),
        depth, 140, 200,
    )  # fmt: skip
    poses = film(ShapesPoses(catalog), scene, 8, overlays=[arm])
    assert len(poses) == 1


def test_names_are_given_by_shape_and_colour_and_the_file_is_written(catalog, tmp_path):
    scene = RenderedScene({"can": standing(CAN, 0.1, 0.05)}, CAMERA)
    path = tmp_path / "names.toml"
    first = ShapesPoses(catalog, {"names": str(path)})
    assert set(film(first, scene, 3)) == {"object_1"}
    first.close()
    path.write_text(path.read_text().replace("object_1", "beans"))
    moved = RenderedScene({"can": standing(CAN, -0.1, 0.0)}, CAMERA)
    poses = film(ShapesPoses(catalog, {"names": str(path)}), moved, 3, seed=1)
    assert set(poses) == {"beans"}
    assert catalog["beans"].name == "beans"


def test_a_name_that_is_given_while_it_runs_holds_in_the_next_run(catalog, tmp_path):
    path = tmp_path / "names.toml"
    first = ShapesPoses(catalog, {"names": str(path)})
    film(first, RenderedScene({"can": standing(CAN, 0.1, 0.05)}, CAMERA), 3)
    first.give_name("object_1", "my beans")
    with pytest.raises(IgripError, match="no unknown thing 'object_7'"):
        first.give_name("object_7", "x")
    first.close()
    assert path.read_text().count("[") == 3  # a table and two lists: nothing else was added
    moved = RenderedScene({"can": standing(CAN, -0.1, 0.0)}, CAMERA)
    again = ShapesPoses(catalog, {"names": str(path)})
    assert set(film(again, moved, 3, seed=1)) == {"my beans"}
    unnamed = ShapesPoses(catalog)
    film(unnamed, moved, 3)
    with pytest.raises(IgripError, match="--option names="):
        unnamed.give_name("object_1", "x")


@pytest.mark.slow
def test_two_cameras_call_a_thing_the_same(catalog):
    objects = {"box": standing(BOX, -0.1, 0.0), "can": standing(CAN, 0.12, 0.0)}
    other = look_at(np.array([0.5, -0.45, 0.5]), np.array([0.0, 0.0, 0.07]))
    first = ShapesPoses(catalog)
    second = first.sibling()
    scenes = RenderedScene(objects, CAMERA), RenderedScene(objects, other)
    one, two = {}, {}
    random = np.random.default_rng(0)
    for k in range(6):
        one = first.estimate(scenes[0].frame(EVERY * k, random))
        two = second.estimate(scenes[1].frame(EVERY * k + 0.03, random))
    assert set(one) == set(two) == {"object_1", "object_2"}
    for placed in objects.values():
        assert nearest(catalog, one, placed)[0] == nearest(catalog, two, placed)[0]


def test_a_camera_without_depth_is_refused(catalog):
    with pytest.raises(IgripError, match="'shapes' needs a camera with depth"):
        ShapesPoses(catalog).estimate(plain_frame(depth=False))
    with pytest.raises(IgripError, match="shapes: "):
        ShapesPoses(catalog, {"nmaes": "x"})
