"""Motions and geometries that are given, to test what is made of them."""

from __future__ import annotations

import numpy as np

from igrip.geometry.cylinder import Cylinders
from igrip.geometry.scene import Geometry
from igrip.motion.trajectory import Motion


def motion(speed=0.5, peak=0.4):
    """Return a motion of which only the speeds matter."""
    zero = np.zeros((3, 3))
    return Motion(0.0, zero[0], zero, zero[0], speed, peak, zero, zero, None)


def geometry(count=3, **arrays):
    """Return a geometry in which only what is given is a number."""
    names = ("vertex", "surface", "future_vertex", "future_surface", "centre", "centre_rate",
             "axial", "half_length")  # fmt: skip
    fields = {name: np.full(count, np.nan) for name in names}
    fields |= {"hits": np.zeros(count, dtype=np.int64), "spread": np.nan}
    fields |= {name: np.asarray(value) for name, value in arrays.items()}
    fields["spread"] = float(fields["spread"])
    pair = np.stack([fields.pop("surface"), fields.pop("future_surface")])
    unknown = Cylinders(np.full_like(Cylinders.zeros(count).rows, np.nan))
    return Geometry(
        objects=list(range(count)), surfaces=lambda: pair, cylinders=lambda: unknown, **fields
    )
