"""The errors of the stereo camera: their size, where nothing is measured, and that seeds hold."""

import numpy as np
import pytest

from igrip.lab.rendering.stereo import StereoNoise, measured_depth, occluded

NONE = StereoNoise(sd_disparity=0, step=0, edge=0, holes=0)
FX = 493.0


def flat(z):
    return np.full((120, 160), z)


def test_without_errors_depth_is_the_truth():
    measured = measured_depth(flat(0.8), np.ones((120, 160)), FX, NONE, np.random.default_rng(0))
    np.testing.assert_allclose(measured, 0.8, rtol=1e-6)


@pytest.mark.parametrize("z", [0.5, 1.0, 1.5])
def test_the_error_grows_with_the_square_of_depth(z):
    noise = StereoNoise(edge=0, holes=0)
    measured = measured_depth(flat(z), np.ones((120, 160)), FX, noise, np.random.default_rng(1))
    expected = z * z * noise.sd_disparity / (FX * noise.baseline)
    assert np.std(measured - z) == pytest.approx(expected, rel=0.1)
    error = measured - z
    assert np.corrcoef(error[:, :-1].ravel(), error[:, 1:].ravel())[0, 1] > 0.7  # spots, not grains


def test_disparities_are_quantised():
    noise = StereoNoise(edge=0, holes=0, step=0.25)
    measured = measured_depth(flat(0.8), np.ones((120, 160)), FX, noise, np.random.default_rng(2))
    steps = FX * noise.baseline / measured.astype(float) / 0.25
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-3)


def test_the_shadow_is_at_the_left_of_what_is_near_and_as_wide_as_the_disparities_differ():
    disparity = np.full((1, 100), 20.0)
    disparity[0, 50:70] = 35.0
    hidden = occluded(disparity)
    assert hidden[0, 36:50].all()
    assert not hidden[0, :35].any()
    assert not hidden[0, 50:].any()


def test_grazing_spots_and_out_of_range_have_no_depth():
    cosine = np.ones((120, 160))
    cosine[:10] = 0.05
    depth = flat(0.8)
    depth[-10:] = np.inf
    depth[-20:-10] = 0.1
    measured = measured_depth(depth, cosine, FX, NONE, np.random.default_rng(3))
    assert not measured[:10].any()
    assert not measured[-20:].any()
    assert measured[10:-20].all()
    holes = StereoNoise(sd_disparity=0, step=0, edge=0, holes=0.05)
    spotted = measured_depth(flat(0.8), np.ones((120, 160)), FX, holes, np.random.default_rng(3))
    assert (spotted == 0).mean() == pytest.approx(0.05, abs=0.005)


def test_one_seed_one_picture():
    pictures = [
        measured_depth(
            flat(0.8), np.ones((120, 160)), FX, StereoNoise(), np.random.default_rng(seed)
        )
        for seed in (5, 5, 6)
    ]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (pictures[0] != pictures[2]).any()
