"""Hands that wear tags, in drawn pictures whose tags are where they are said to be."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pupil_apriltags", reason="tags are found by pupil-apriltags")

from igrip.errors import IgripError
from igrip.perception.hands import HANDS
from igrip.perception.hands.tags import TagHands
from igrip.perception.pipeline.stages import hand_stages
from tag_pictures import draw, pose

SIZE = 0.05
OFFSET = np.array([0.01, 0.08, -0.03])
RIGHT = {"hand": "right", "size": SIZE, "palm": OFFSET.tolist()}


def true_palm(camera_from_tag):
    return camera_from_tag[:3, :3] @ OFFSET + camera_from_tag[:3, 3]


def test_it_is_a_member_of_its_family():
    assert "tags" in HANDS.names()


@pytest.mark.parametrize("turn", [(0.4, 0.2, 0.1), (-0.5, 0.1, 1.2), (0.1, 0.6, -0.7)])
def test_the_palm_is_where_the_tag_says_with_a_webcam_alone(turn):
    truth = pose((0.03, -0.02, 0.5), turn)
    found = TagHands({"tags": {7: RIGHT}}).detect(draw([(7, SIZE, truth)]))
    assert [hand.label for hand in found] == ["right"]
    measured = found[0].measured
    off = np.array(measured.position) - true_palm(truth)
    assert np.linalg.norm(off) < 0.012
    assert (np.abs(off) < 3.5 * np.array(measured.std)).all()
    assert min(measured.std) >= 0.008


def test_each_hand_by_its_own_tag_and_no_other():
    one, other = pose((-0.1, 0.0, 0.5), (0.4, 0.1, 0.0)), pose((0.1, 0.0, 0.5), (0.4, -0.2, 0.3))
    tags = {3: {**RIGHT, "hand": "left"}, 7: RIGHT}
    frame = draw([(3, SIZE, one), (7, SIZE, other), (9, SIZE, pose((0.0, 0.1, 0.6), (0.3, 0, 0)))])
    found = {hand.label: np.array(hand.measured.position)
             for hand in TagHands({"tags": tags}).detect(frame)}  # fmt: skip
    assert set(found) == {"left", "right"}
    assert np.linalg.norm(found["left"] - true_palm(one)) < 0.015
    assert np.linalg.norm(found["right"] - true_palm(other)) < 0.015


def test_the_file_is_read(tmp_path):
    path = tmp_path / "hands.toml"
    path.write_text('[tags.7]\nhand = "left"\nsize = 0.05\npalm = [0, 0.07, 0]\n')
    truth = pose((0.0, 0.0, 0.4), (0.4, 0.2, 0.0))
    stage = hand_stages("tags", 2, options={"tags": str(path)})()
    for k in range(4):
        found = stage(draw([(7, SIZE, truth)], t=k / 30, seed=k))
    assert list(found.hands) == ["left"]
    stage.close()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "which tags are on which hand"),
        ({"tags": "nowhere.toml"}, "nowhere.toml"),
        ({"tags": {7: {**RIGHT, "hand": "third"}}}, "hands tags"),
        ({"tags": {7: {**RIGHT, "orientation": [0, 0, 0, 2]}}}, "is not a rotation"),
        ({"tags": {7: RIGHT, 8: {**RIGHT, "palm": [0, 0, 0]}}}, "share a frame"),
    ],
)
def test_wrong_options_are_refused(options, words):
    with pytest.raises(IgripError, match=words):
        TagHands(options)
