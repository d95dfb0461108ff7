"""The rendered camera as any other."""

import numpy as np
import pytest

from igrip.perception.cameras import CameraError, open_camera


def test_it_yields_frames_until_it_is_closed():
    camera = open_camera("rendered:1")
    times, pictures = [], []
    for frame in camera:
        times.append(frame.t)
        pictures.append(frame.depth)
        if len(times) == 3:
            camera.close()
            camera.close()
    assert times == sorted(times)
    assert len(times) == 3
    assert (pictures[0] != pictures[1]).any()  # the noise is new
    assert np.median(np.abs(pictures[0] - pictures[1])) < 0.02


@pytest.mark.parametrize("name", ["rendered:x", "rendered:-1"])
def test_a_wrong_seed_is_explained(name):
    with pytest.raises(CameraError, match="rendered:"):
        open_camera(name)
