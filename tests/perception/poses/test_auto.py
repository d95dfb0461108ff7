"""The pose estimator ``auto``: known things by name, the others as shapes."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.errors import IgripError
from igrip.lab.rendering.scene import RenderedScene
from igrip.objects.catalog import load_objects
from igrip.perception.poses.auto import AutoPoses
from igrip.rgbd import Intrinsics, RgbdFrame
from standing import CAMERA, standing

MUSTARD = "006_mustard_bottle"


@pytest.fixture
def catalog():
    return load_objects("ycb")


def middle_of(catalog, pose):
    turn = Rotation.from_quat(pose.orientation).as_matrix()
    return turn @ catalog[pose.model].sphere[:3] + pose.position


@pytest.mark.slow
def test_catalogue_models_win_and_the_rest_are_shapes(catalog):
    scene = RenderedScene(
        {"mustard": standing(catalog[MUSTARD], -0.15, 0.05),
         "mug": standing(catalog["025_mug"], 0.12, 0.0)}, CAMERA,
    )  # fmt: skip
    estimator = AutoPoses(catalog, {"models": [MUSTARD]})
    random = np.random.default_rng(0)
    for k in range(8):
        poses = estimator.estimate(scene.frame(0.1 * k, random))
    assert {id for id, pose in poses.items() if pose is not None} == {MUSTARD, "object_1"}
    assert poses[MUSTARD].source == "depth"
    assert poses["object_1"].source == "shapes"
    mug = scene.objects["mug"]
    true = mug.pose[:3, :3] @ mug.model.sphere[:3] + mug.pose[:3, 3]
    assert np.linalg.norm(middle_of(catalog, poses["object_1"]) - true) < 0.03


def test_options_go_to_the_one_that_has_them(catalog, tmp_path):
    AutoPoses(catalog, {"models": [MUSTARD], "stride": 3, "names": str(tmp_path / "n.toml")})
    with pytest.raises(IgripError, match="nmaes"):
        AutoPoses(catalog, {"models": [MUSTARD], "nmaes": "x"})


def real_frame(shared, name):
    cv2 = pytest.importorskip("cv2")
    about = json.loads((shared / "rgbd" / "frames.json").read_text())[name]
    colour = cv2.imread(str(shared / "rgbd" / f"{name}_colour.jpg"))[..., ::-1]
    depth = cv2.imread(str(shared / "rgbd" / f"{name}_depth.png"), cv2.IMREAD_UNCHANGED) * 1e-3
    pinhole = Intrinsics(*(about[key] for key in ("width", "height", "fx", "fy", "cx", "cy")))
    return np.ascontiguousarray(colour), depth.astype(np.float32), pinhole


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size"),  # edges in metres, measured on such things by their makers
    [("6dof_sugar", (0.175, 0.095, 0.045)), ("6dof_cheezit", (0.21, 0.16, 0.06))],
)
def test_real_boxes_are_measured(shared_data, catalog, name, size):
    colour, depth, pinhole = real_frame(shared_data, name)
    estimator = AutoPoses(catalog, {"models": [MUSTARD]})
    for k in range(4):
        poses = estimator.estimate(RgbdFrame(0.1 * k, colour, depth, pinhole, "c", np.eye(4)))
    (pose,) = [pose for pose in poses.values() if pose is not None]
    height = catalog[pose.model].length
    assert height == pytest.approx(size[0], rel=0.1)
