"""Rigid transforms and the messages that carry them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from igrip.perception.transforms import inverse, is_rigid, object_pose, rigid

TURN = Rotation.from_euler("xyz", [0.3, -0.8, 1.9])
POSE = rigid(TURN.as_matrix(), (0.1, -0.2, 0.7))


def test_the_inverse_undoes_it():
    np.testing.assert_allclose(inverse(POSE) @ POSE, np.eye(4), atol=1e-15)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (np.eye(4), True),
        (np.diag([1.0, 1.0, -1.0, 1.0]), False),  # a mirror
        (np.diag([1.01, 1.0, 1.0, 1.0]), False),
        (np.diag([1.0, 1.0, 1.0, 2.0]), False),
        (np.full((4, 4), np.nan), False),
    ],
)
def test_what_is_rigid(change, expected):
    assert is_rigid(POSE @ change, 1e-3) == expected


def test_a_message_has_the_pose_in_the_world():
    message = object_pose(POSE, model="box", t=1.5, score=0.5, source="test")
    assert message.position == (0.1, -0.2, 0.7)
    assert (message.model, message.t, message.score, message.source) == ("box", 1.5, 0.5, "test")
    np.testing.assert_allclose(
        Rotation.from_quat(message.orientation).as_matrix(), TURN.as_matrix(), atol=1e-15
    )
