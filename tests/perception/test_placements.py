"""The file that says where cameras stand."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.errors import CameraError
from igrip.perception.placements import Placement, read_placements, write_placements


def test_a_file_comes_back(tmp_path):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", [0.1, -0.7, 2.0]).as_matrix()
    pose[:3, 3] = 1 / 3, 0.2, -5.0
    placements = {"left": Placement(pose, 0.1, 0.001, 15, 30, None)}
    placements["right"] = placements["left"]._replace(world_from_camera=np.eye(4))
    write_placements(tmp_path / "c.json", placements, {"columns": 5})
    poses = read_placements(tmp_path / "c.json")
    assert set(poses) == {"left", "right"}
    for name, pose in poses.items():
        assert np.array_equal(pose, placements[name].world_from_camera)
    assert json.loads((tmp_path / "c.json").read_text())["board"] == {"columns": 5}
    with pytest.raises(CameraError, match="nowhere"):
        write_placements(tmp_path / "nowhere" / "c.json", placements, {})


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "{}", '{"format": "other"}', '{"format": "igrip-calibration/1", "cameras": 3}',
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": [1, 2]}}}',
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": '
        "[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}}}",
        '{"format": "igrip-calibration/1", "cameras": {"a": {"world_from_camera": '
        "[[1,0,0,NaN],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}}",
    ],
)  # fmt: skip
def test_files_that_are_none(tmp_path, text):
    (tmp_path / "c.json").write_text(text)
    with pytest.raises(CameraError, match=r"c\.json"):
        read_placements(tmp_path / "c.json")


def test_a_missing_file(tmp_path):
    with pytest.raises(CameraError, match="No such file"):
        read_placements(tmp_path / "c.json")
