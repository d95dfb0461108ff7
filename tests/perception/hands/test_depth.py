"""Hands at the ends of arms: arithmetic pictures from above, rendered arms that wear something."""

from __future__ import annotations

import numpy as np
import pytest

from arms_from_above import CAMERA, View, palm_point
from benchmarks.measure_worn_arms import rendered
from benchmarks.worn_arms import KINDS
from igrip.errors import IgripError
from igrip.perception.hand_ids import HandIdConfig
from igrip.perception.hands import HANDS
from igrip.perception.hands.depth import DepthHands, DepthHandsConfig
from igrip.perception.pipeline.stages import HandIds, HandStage
from igrip.rgbd import RgbdFrame

RATE = 30.0
ELBOW = (0.1, 0.75)


def run(detector, views):
    """Return the palms found in each of several views."""
    return [
        [np.array(hand.measured.position) for hand in detector.detect(view.frame(k / RATE))]
        for k, view in enumerate(views)
    ]


def arriving(steps, goal=(0.0, 0.0), start=(0.05, 0.5)):
    """Yield the places of a palm that comes in from below."""
    for k in range(steps):
        share = k / (steps - 1)
        yield tuple(np.array(start) + share * (np.array(goal) - np.array(start)))


def test_it_is_a_member_of_its_family():
    assert "depth" in HANDS.names()


def test_the_palm_of_an_arm_that_comes_in_is_measured():
    places = list(arriving(20))
    views = [View(k) for k in range(5)] + [View(k).arm(p, ELBOW) for k, p in enumerate(places)]
    found = run(DepthHands(), views)[5:]
    over = [k for k, (_, y) in enumerate(places) if y < 0.3]  # the wrist is in view
    assert all(len(found[k]) == 1 for k in over)
    off = [np.linalg.norm(found[k][0] - palm_point(*places[k])) for k in over]
    assert np.median(off) < 0.025
    assert np.percentile(off, 95) < 0.040


def test_its_uncertainty_is_that_of_its_errors():
    views = [View(k) for k in range(5)] + [View(k).arm(p, ELBOW) for k, p in
                                           enumerate(arriving(20))]  # fmt: skip
    detector = DepthHands()
    hand = [detector.detect(view.frame(k / RATE)) for k, view in enumerate(views)][-1][0]
    off = np.array(hand.measured.position) - palm_point(0.0, 0.0)
    assert (np.abs(off) < 3.0 * np.array(hand.measured.std)).all()
    pixel = CAMERA.pixels(np.array(hand.measured.position)[None])[0]
    np.testing.assert_allclose(hand.landmarks[0], pixel, atol=1.0)


def test_what_stands_on_the_table_is_no_hand():
    views = [View(k).block(-0.2, 0.0).block(0.2, 0.2).block(0.45, 0.42, 0.15) for k in range(60)]
    assert not any(run(DepthHands(), views))


def test_a_still_thing_like_an_arm_is_learned_away():
    detector = DepthHands(DepthHandsConfig(still=0.5, settle=0.3))
    found = run(detector, [View(k).arm((-0.2, 0.1), (-0.2, 0.8)) for k in range(60)])
    assert not any(found[40:])
    # and the arm that comes in beside it is found alone
    places = list(arriving(15, (0.1, 0.0), (0.15, 0.5)))
    found = [
        detector.detect(View(k).arm((-0.2, 0.1), (-0.2, 0.8)).arm(p, (0.2, 0.8)).frame(2 + k / 30))
        for k, p in enumerate(places)
    ]
    assert len(found[-1]) == 1
    off = np.array(found[-1][0].measured.position) - palm_point(*places[-1])
    assert np.linalg.norm(off) < 0.03


def test_a_pushed_block_is_no_second_hand():
    def scene(k):
        y = 0.3 - 0.008 * max(k - 8, 0)
        block = min(0.02, y - 0.15)
        view = View(k).block(0.0, block)
        return view.arm((0.0, y), (0.05, 0.8)) if k >= 4 else view

    found = run(DepthHands(), [scene(k) for k in range(45)])
    assert max(map(len, found)) == 1


def test_two_arms_that_cross_keep_their_ids():
    stage = HandStage(DepthHands(), HandIds(HandIdConfig(), False))
    sides = []
    for k in range(70):
        x = 0.22 - 0.0085 * max(k - 10, 0)
        x = max(x, -0.22)
        y = min(0.45, 0.15 + 0.3 * max(0, 8 - k) / 8)
        view = View(k)
        if k >= 3:
            view = view.arm((x, y - 0.06), (0.3, 0.85), 0.06).arm((-x, y + 0.06), (-0.3, 0.85), 0.2)
        found = stage(view.frame(k / RATE)).hands
        sides.append({id: hand.position[0] for id, hand in found.items() if hand is not None})
    first = next(side for side in sides if len(side) == 2)
    right = max(first, key=first.get)
    left = min(first, key=first.get)
    assert sides[-1][right] < -0.15
    assert sides[-1][left] > 0.15
    assert set().union(*sides) == {right, left}


def test_people_on_both_sides_have_a_hand_each():
    views = [View(k) for k in range(4)] + [
        View(k).arm((0.15, y), (0.2, 0.8)).arm((-0.15, -y), (-0.2, -0.8))
        for k, (_, y) in enumerate(arriving(15, (0, 0.15), (0, 0.5)))
    ]
    found = run(DepthHands(), views)[-1]
    assert len(found) == 2
    for x, y in ((0.15, 0.15), (-0.15, -0.15)):
        assert min(np.linalg.norm(one - palm_point(x, y)) for one in found) < 0.03


def test_without_a_table_it_says_so():
    detector = DepthHands()
    rng = np.random.default_rng(0)
    cloud = rng.uniform(0.3, 2.5, (240, 320)).astype(np.float32)
    far = np.full((240, 320), 2.5, np.float32)
    nothing = np.zeros((240, 320), np.float32)
    for depth, words in ((cloud, "no plane"), (far, "2.5 m"), (nothing, "no plane")):
        frame = RgbdFrame(0.0, np.zeros((240, 320, 3), np.uint8), depth, CAMERA)
        assert detector.detect(frame) == []
        assert "no table" in detector.problem
        assert words in detector.problem
    assert detector.detect(View().frame(1.0)) == []
    stage = HandStage(detector, HandIds(HandIdConfig(), False))
    assert stage.problem is None


def test_a_camera_without_depth_is_refused():
    frame = RgbdFrame(0.0, np.zeros((240, 320, 3), np.uint8), None, CAMERA)
    with pytest.raises(IgripError, match="needs a camera with depth"):
        DepthHands().detect(frame)


def test_a_wrong_option_is_named():
    with pytest.raises(IgripError, match="hands depth"):
        DepthHands({"settel": 1.0})


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_what_an_arm_wears_does_not_matter(kind):
    result = rendered(kind, (0.0, 40.0), 14)
    assert result.extra == 0
    assert len(result.off) >= 0.9 * result.frames
    assert np.median(result.off) < 0.025


def test_no_hand_where_real_things_stand(shared_data):
    cv2 = pytest.importorskip("cv2")
    import json

    folder = shared_data / "rgbd"
    frames = json.loads((folder / "frames.json").read_text())
    assert frames
    count = 0
    for path in sorted(folder.glob("*_depth.png"))[::2]:
        depth = cv2.imread(str(path), cv2.IMREAD_UNCHANGED).astype(np.float32) / 1000.0
        height, width = depth.shape
        camera = CAMERA.scaled(width, height)
        detector, rng = DepthHands(), np.random.default_rng(0)
        for k in range(12):
            noisy = np.where(depth > 0, depth + 0.001 * rng.standard_normal(depth.shape), 0)
            picture = np.zeros((height, width, 3), np.uint8)
            frame = RgbdFrame(k / RATE, picture, noisy.astype(np.float32), camera)
            count += len(detector.detect(frame))
    assert count == 0
