"""Tags in pictures: which are detected, and which are not.

How exact their corners are: tests/perception/poses/test_tag_pose.py.
"""

from __future__ import annotations

import pytest

pytest.importorskip("cv2", reason="tags are drawn by OpenCV")
pytest.importorskip("pupil_apriltags", reason="tags are detected by pupil-apriltags")

from igrip.errors import UnknownNameError
from igrip.perception.tag_detector import TagDetector
from tag_pictures import draw, pose

SIZE = 0.05


@pytest.fixture(scope="module")
def detector():
    return TagDetector()


def test_a_number_that_is_there_twice_is_left_out(detector):
    twice = [(7, SIZE, pose([x, 0.0, 0.5], [0.2, 0.0, 0.0])) for x in (-0.08, 0.08)]
    other = (9, SIZE, pose([0.0, 0.1, 0.5], [0.2, 0.0, 0.0]))
    assert [tag.id for tag in detector.detect(draw([*twice, other]))] == [9]


def test_noise_is_no_tag(detector):
    assert detector.detect(draw([], noise=40.0)) == []


def test_an_unknown_family_is_named():
    with pytest.raises(UnknownNameError, match="tag36h11"):
        TagDetector("tag99")
