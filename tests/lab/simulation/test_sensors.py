"""What the camera makes of a scene, as often and as much as its parameters say."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.lab.simulation.parameters import CameraParameters, ProtocolParameters
from igrip.lab.simulation.sensors import lose, measure_points, observe_scene, place_camera
from igrip.lab.simulation.table import models_by_id, set_table

AT = np.array([0.0, -0.1, 0.5])
PERFECT = dict.fromkeys(
    (
        "lateral_noise", "disparity_noise", "outliers", "lost", "swapped", "duplicated",
        "object_bias", "object_bias_turn", "object_jitter", "object_jitter_turn", "flips",
        "object_lost", "never_found", "occluded",
    ),
    0.0,
)  # fmt: skip


def still(n=600):
    return {"left": np.tile([-0.2, 0.0, 0.04], (n, 1)), "right": np.tile([0.2, 0.0, 0.04], (n, 1))}


def filmed(ycb, camera, n=600, seed=0, palms=None):
    random = np.random.default_rng(seed)
    table = set_table(models_by_id(ycb), ProtocolParameters(), random)
    palms = palms or still(n)
    return table, observe_scene(np.arange(n) / 30, palms, table, AT, camera, random)


def test_a_perfect_camera_reports_the_truth(ycb):
    table, messages = filmed(ycb, CameraParameters(**PERFECT))
    assert all(m.hands["left"].position == (-0.2, 0.0, 0.04) for m in messages)
    poses = [m.objects for m in messages if m.objects]
    assert len(poses) / (600 / 30) == pytest.approx(12.5, abs=0.3)
    for id, pose in poses[5].items():
        assert pose.position == pytest.approx(table.places[id])
        turned = Rotation.from_quat(pose.orientation).as_matrix()
        assert turned == pytest.approx(table.rotation(id), abs=1e-12)
    late = [m.t - m.objects["soup"].t for m in messages if m.objects and m.t > 1.0]
    assert late == pytest.approx([0.12] * len(late), abs=1e-3)


def test_depth_noise_is_that_of_a_stereo_camera():
    camera = CameraParameters(**{**PERFECT, "disparity_noise": 0.5})
    points = np.tile([0.0, 0.5, 0.0], (20_000, 1))
    noise = measure_points(points, AT, camera, np.random.default_rng(0)) - points
    z = np.linalg.norm(points[0] - AT)
    along = (points[0] - AT) / z
    assert (noise @ along).std() == pytest.approx(z * z * 0.5 / (800 * 0.075), rel=0.05)
    across = noise - (noise @ along)[:, None] * along
    assert np.abs(across).max() < 1e-12


def test_lateral_noise_is_correlated_from_frame_to_frame():
    camera = CameraParameters(**{**PERFECT, "lateral_noise": 0.002, "correlation": 0.6})
    points = np.tile([0.0, 0.5, 0.0], (20_000, 1))
    noise = (measure_points(points, AT, camera, np.random.default_rng(0)) - points)[:, 0]
    assert noise.std() == pytest.approx(0.002, rel=0.05)
    assert np.corrcoef(noise[:-1], noise[1:])[0, 1] == pytest.approx(0.6, abs=0.03)


def test_bursts_of_lost_frames():
    lost = lose(np.full(100_000, 0.01), 3.0, np.random.default_rng(0))
    assert lost.mean() == pytest.approx(0.03, abs=0.004)
    begins = np.flatnonzero(np.diff(lost.astype(int)) == 1)
    assert lost.sum() / len(begins) == pytest.approx(3.0, rel=0.1)
    assert not lose(np.zeros(100), 3.0, np.random.default_rng(0)).any()


def test_labels_are_swapped_and_doubled(ycb):
    _, messages = filmed(ycb, CameraParameters(**{**PERFECT, "swapped": 0.1, "duplicated": 0.1}))
    left = np.array([m.hands["left"].position[0] for m in messages])
    right = np.array([m.hands["right"].position[0] for m in messages])
    assert ((left > 0) & (right < 0)).mean() == pytest.approx(0.1, abs=0.04)
    assert (left == right).mean() == pytest.approx(0.09, abs=0.04)


def test_an_arm_before_an_object_hides_it(ycb):
    random = np.random.default_rng(3)
    table = set_table(models_by_id(ycb), ProtocolParameters(), random)
    hidden = table.middle("soup")
    palm = AT + 0.6 * (hidden - AT)
    camera = CameraParameters(**{**PERFECT, "occluded": 1.0})
    messages = observe_scene(
        np.arange(60) / 30, {"right": np.tile(palm, (60, 1))}, table, AT, camera, random
    )
    looks = [m.objects["soup"] for m in messages if m.objects]
    assert looks == [None] * len(looks)


def test_flips_keep_the_place_and_turn_by_a_symmetry(ycb):
    table, messages = filmed(ycb, CameraParameters(**{**PERFECT, "flips": 1.0}))
    pose = next(m.objects["cracker"] for m in messages if m.objects)
    turned = Rotation.from_quat(pose.orientation)
    middle = turned.apply(table.models["cracker"].origin) + pose.position
    assert middle == pytest.approx(table.middle("cracker"), abs=1e-9)
    turn = turned * Rotation.from_matrix(table.rotation("cracker")).inv()
    assert turn.magnitude() == pytest.approx(np.pi)


def test_cameras_stand_on_their_sides():
    for side, sign in (("left", -1), ("right", 1)):
        places = [
            place_camera(CameraParameters(), side, np.random.default_rng(k)) for k in range(50)
        ]
        assert np.mean(places, axis=0) == pytest.approx([sign * 0.45, -0.1, 0.5], abs=0.02)
