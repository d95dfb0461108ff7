"""Made-up frames of a camera: a slope of depth and noise in colour, small and seeded."""

import numpy as np

from igrip.rgbd import Intrinsics, RgbdFrame

SMALL = Intrinsics(64, 48, 60.0, 61.0, 31.5, 23.0)


def frame(k=0, t=None, camera="camera", intrinsics=SMALL, depth=True, place=None):
    """Return frame number k at 30 Hz; its depth is whole tenths of a millimetre."""
    rng = np.random.default_rng(k)
    shape = (intrinsics.height, intrinsics.width)
    colour = rng.integers(0, 256, (*shape, 3), dtype=np.uint8)
    counts = np.add.outer(np.arange(shape[0]) * 7, np.arange(shape[1]) * 13) + 5000 + k
    counts[:4, :4] = 0  # not measured
    metres = (counts * 1e-4).astype(np.float32) if depth else None
    t = 10.0 + k / 30 if t is None else t
    return RgbdFrame(t, colour, metres, intrinsics, camera, np.eye(4) if place is None else place)


def same(a, b):
    """Say whether two frames are equal to the last bit, but for nanoseconds of time."""
    depths = a.depth is b.depth is None or np.array_equal(a.depth, b.depth)
    return (
        abs(a.t - b.t) < 1e-9 and np.array_equal(a.colour, b.colour) and depths
        and a.intrinsics == b.intrinsics and a.camera == b.camera
        and np.allclose(a.world_from_camera, b.world_from_camera, rtol=0, atol=1e-12)
    )  # fmt: skip
