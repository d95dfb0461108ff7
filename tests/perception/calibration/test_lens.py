"""A lens that is calibrated with a board is the one the pictures were made with."""

import cv2
import numpy as np
import pytest

from board_pictures import CAMERA, looking_at, see
from igrip.errors import CameraError
from igrip.perception.calibration.board import Board
from igrip.perception.calibration.lens import calibrate_lens
from igrip.perception.lens import Rectifier, write_lens
from igrip.rgbd import RgbdFrame

BOARD = Board()
BENT = np.array([-0.12, 0.05, 0.001, -0.0005, 0.0])


def bend(frame):
    """Return a frame as a lens with distortion would see it."""
    v, u = np.mgrid[: CAMERA.height, : CAMERA.width].astype(np.float32)
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)[:, None]
    straight = cv2.undistortPoints(pixels, CAMERA.matrix, BENT, P=CAMERA.matrix)
    across, down = straight.reshape(CAMERA.height, CAMERA.width, 2).transpose(2, 0, 1)
    colour = cv2.remap(
        frame.colour, across.astype(np.float32), down.astype(np.float32), cv2.INTER_LINEAR
    )
    return RgbdFrame(frame.t, colour, None, frame.intrinsics)


def views(count=12, change=bend):
    """Yield pictures of a board that is held here and there."""
    rng = np.random.default_rng(3)
    for k in range(count):
        place = np.array([*rng.uniform(-0.25, 0.25, 2), rng.uniform(0.28, 0.45)])
        target = (*rng.uniform(-0.08, 0.08, 2), 0.0)
        yield change(see(BOARD, looking_at(place, target), k / 30, seed=k))


def test_a_lens_is_calibrated(tmp_path):
    found = calibrate_lens(views(), BOARD, views=12)
    assert found.error < 0.3
    intrinsics, distortion = found.lens
    assert intrinsics[:2] == (1280, 720)
    assert intrinsics[2:4] == pytest.approx((900.0, 902.0), rel=0.005)
    assert intrinsics[4:] == pytest.approx((640.3, 358.8), abs=4.0)
    assert distortion[:2] == pytest.approx(BENT[:2], abs=0.05)
    write_lens(tmp_path / "lens.json", found.lens, found.error)
    frame = next(iter(views(1, change=lambda frame: frame)))
    straight, own = Rectifier(str(tmp_path / "lens.json")).rectify(bend(frame).colour)
    assert own.fx == pytest.approx(intrinsics.fx)
    inside = np.s_[100:-100, 200:-200, 0]
    wrong = np.abs(straight[inside].astype(float) - frame.colour[inside])
    assert np.mean(wrong > 80) < 0.01  # edges lie on edges
    crooked = np.abs(bend(frame).colour[inside].astype(float) - frame.colour[inside])
    assert np.mean(crooked > 80) > 0.02


def test_one_view_again_and_again_is_not_enough():
    frame = next(iter(views(1)))
    again = (RgbdFrame(k / 30, frame.colour, None, frame.intrinsics) for k in range(5))
    with pytest.raises(CameraError, match="seen in 1 places, 8 are needed"):
        calibrate_lens(again, BOARD)


def test_a_file_that_cannot_be_written(tmp_path):
    found = calibrate_lens(views(8, change=lambda frame: frame), BOARD, views=8)
    assert np.abs(found.lens.distortion[:2]).max() < 0.05
    with pytest.raises(CameraError, match="nowhere"):
        write_lens(tmp_path / "nowhere" / "lens.json", found.lens, found.error)
