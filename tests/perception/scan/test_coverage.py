"""How far round a thing was seen: counted by hand."""

import numpy as np
import pytest

from igrip.perception.scan.coverage import degrees_covered


@pytest.mark.parametrize(
    ("yaws", "seen"),
    [
        ([], 0), ([10], 60), ([0, 30], 90), ([0, 30, -30], 120), ([0, 100], 120),
        (range(0, 360, 60), 360), (range(0, -720, -60), 360), (range(0, 360, 90), 240),
        ([350, 10], 80),
    ],
)  # fmt: skip
def test_each_view_counts_for_its_arc(yaws, seen):
    assert degrees_covered(list(np.radians(list(yaws))), 60.0) == pytest.approx(seen)
