"""Hands cut out of a film, and put into frames."""

from __future__ import annotations

import numpy as np
import pytest

from hands import CAMERA, desk, hand_detector_or_skip
from igrip.errors import IgripError
from igrip.lab.rendering.drawn_hand import paste_hand
from igrip.perception.hands import PALM, palm_length
from igrip.rgbd import RgbdFrame

pytest.importorskip("cv2", reason="hands are cut out by OpenCV")

from benchmarks.film_sprites import film_sprites


def test_a_real_hand_is_cut_out_whole(shared_data):
    detector = hand_detector_or_skip(max_hands=1)
    film = film_sprites(shared_data / "images" / "hand_720p.mp4", detector, every=20)
    sprite = next(film)
    height, width = sprite.alpha.shape
    u, v = np.clip(np.round(sprite.landmarks).astype(int), 0, [width - 1, height - 1]).T
    assert sprite.alpha[v, u].mean() > 0.95  # the landmarks are on it
    assert 0.1 < (sprite.alpha > 0.5).mean() < 0.6
    found = []
    for k in range(5):
        frame, truth = paste_hand(desk(), sprite, (300.0, 230.0), 0.6)
        found = detector.detect(RgbdFrame(k / 30, frame.colour, None, CAMERA, "desk"))
    assert len(found) == 1
    off = found[0].landmarks[list(PALM)] - truth[list(PALM)]
    assert np.linalg.norm(off.mean(axis=0)) < 0.15 * palm_length(truth)
    detector.close()


def test_what_is_no_film_is_refused(tmp_path):
    (tmp_path / "no.mp4").write_bytes(b"no film")
    with pytest.raises(IgripError, match="no film"):
        list(film_sprites(tmp_path / "no.mp4", None))
