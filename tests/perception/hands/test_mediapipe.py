"""Hands by MediaPipe in real pictures, and in made ones where their place is known."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from hands import CAMERA, desk, hand_detector_or_skip
from igrip.errors import MissingExtraError
from igrip.lab.rendering.drawn_hand import draw_hand, paste_hand
from igrip.perception.hands import HANDS, PALM, palm_length
from igrip.perception.hands._palms import measure_palm
from igrip.rgbd import Intrinsics, RgbdFrame


@pytest.fixture
def detectors():
    made = []

    def make(**config):
        made.append(hand_detector_or_skip(**config))
        return made[-1]

    yield make
    for each in made:
        each.close()


def at(frame, t):
    return RgbdFrame(t, frame.colour, frame.depth, frame.intrinsics, frame.camera)


def picture_of(path):
    cv2 = pytest.importorskip("cv2")
    colour = cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)
    height, width = colour.shape[:2]
    return RgbdFrame(0.0, colour, None, Intrinsics(width, height, 600.0, 600.0, 300.0, 200.0))


def palm_of(landmarks):
    return landmarks[list(PALM)].mean(axis=0)


def test_it_is_a_member_of_its_family():
    assert "mediapipe" in HANDS.names()


def test_a_drawn_hand_is_found_where_it_is_and_measured_in_metres(detectors):
    frame, truth = paste_hand(desk(), draw_hand(), (300.0, 260.0), 0.6)
    detector = detectors()
    found = [detector.detect(at(frame, k / 30)) for k in range(5)][-1]
    assert len(found) == 1
    off = np.linalg.norm(palm_of(found[0].landmarks) - palm_of(truth)) / palm_length(truth)
    assert off < 0.2
    assert 0.5 < found[0].score <= 1.0
    measured = measure_palm(found[0], frame)
    true = CAMERA.points(palm_of(truth)[None], np.array([0.6]))[0]
    np.testing.assert_allclose(measured.position, true, atol=0.02)


def test_two_hands_are_two_and_the_surer_is_first(detectors):
    frame, _ = paste_hand(desk(), draw_hand(), (180.0, 260.0), 0.6)
    frame, _ = paste_hand(frame, draw_hand(seed=1), (460.0, 260.0), 0.7, turn=0.3)
    detector = detectors()
    found = [detector.detect(at(frame, k / 30)) for k in range(8)][-1]
    assert len(found) == 2
    assert found[0].score >= found[1].score


def test_never_more_than_were_asked_for(detectors):
    frame, _ = paste_hand(desk(), draw_hand(), (180.0, 260.0), 0.6)
    frame, _ = paste_hand(frame, draw_hand(seed=1), (460.0, 260.0), 0.6)
    detector = detectors(max_hands=1)
    assert all(len(detector.detect(at(frame, k / 30))) <= 1 for k in range(5))


def test_an_empty_desk_holds_no_hand(detectors):
    detector = detectors(search_every=1)
    assert all(detector.detect(at(desk(k), k / 30)) == [] for k in range(12))


def test_times_that_repeat_or_go_back_do_no_harm(detectors):
    frame, _ = paste_hand(desk(), draw_hand(), (300.0, 260.0), 0.6)
    detector = detectors(max_hands=1)
    for t in (1.0, 1.0, 1.0001, 0.5, 0.5, 7.0):
        assert len(detector.detect(at(frame, t))) == 1


def test_cameras_are_kept_apart(detectors):
    frame, _ = paste_hand(desk(), draw_hand(), (300.0, 260.0), 0.6)
    detector = detectors(max_hands=1, tiles=0)
    for k in range(4):
        assert len(detector.detect(at(frame, k / 30))) == 1
        other = RgbdFrame(k / 30, desk().colour, None, CAMERA, camera="other")
        assert detector.detect(other) == []


def test_without_the_package_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "mediapipe", None)
    with pytest.raises(MissingExtraError, match=r"\(extra hands\): pip install 'mediapipe"):
        HANDS.get("mediapipe")()


def test_the_hand_of_the_film_is_found(detectors, shared_data):
    cv2 = pytest.importorskip("cv2")
    film = cv2.VideoCapture(str(shared_data / "images" / "hand_720p.mp4"))
    camera = Intrinsics(1280, 720, 900.0, 900.0, 640.0, 360.0)
    detector, counts = detectors(), []
    for k in range(120):  # all 621: benchmarks/measure_hands.py
        good, picture = film.read()
        assert good
        colour = cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)
        counts.append(len(detector.detect(RgbdFrame(k / 30, colour, None, camera))))
    assert np.mean(np.array(counts) >= 1) >= 0.99
    assert np.mean(np.array(counts) > 1) <= 0.02  # there is but one


@pytest.mark.parametrize(
    ("name", "palms"),
    [
        ("experiment_side_a.png", ((135, 315), (203, 360))),
        ("experiment_side_b.png", ((655, 345), (582, 395))),
    ],
)
def test_both_clasped_hands_of_the_experiment_are_found(detectors, shared_data, name, palms):
    frame = picture_of(shared_data / "images" / name)
    detector = detectors()
    found = [detector.detect(at(frame, k / 30)) for k in range(75)][-1]
    assert len(found) == 2
    for palm in palms:
        assert min(np.linalg.norm(palm_of(hand.landmarks) - palm) for hand in found) < 40


def test_no_hand_is_seen_where_none_is(detectors, shared_data):
    frame = picture_of(shared_data / "images" / "ycbv_000629_rgb.png")
    detector = detectors(search_every=1)
    assert all(detector.detect(at(frame, k / 30)) == [] for k in range(12))
