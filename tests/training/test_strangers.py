"""Sets that nothing is learned from, read as reaches; and hands that reach for nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from training.hands_at_work import CLEARANCE, MIN_SECONDS, hands_at_work
from training.held_out import CLEARANCE as KEPT
from training.held_out import NAMES, NOISE, held_out
from training.moments import catalog


@pytest.fixture(scope="module")
def shared(shared_data):
    for name in (*NAMES, "hands_at_work"):
        if not (shared_data / name).exists():
            pytest.skip(f"the shared data has no {name}")
    return shared_data


def palms(recording):
    return np.array([m.hands["right"].position for m in recording.messages if m.hands])


def gaps(positions, recording):
    """Least distance of positions from the middle of each object's cylinder, by id [m]."""
    return {
        id: np.linalg.norm(
            positions - pose.position - Rotation.from_quat(pose.orientation).apply(
                catalog()[pose.model].origin
            ), axis=1,
        ).min()
        for id, pose in recording.messages[0].objects.items()
    }  # fmt: skip


@pytest.mark.parametrize(("name", "count"), [*zip(NAMES, (55, 248, 45), strict=True)])
def test_rivals_keep_from_the_path_that_leads_to_the_target(shared, name, count):
    recordings = list(held_out(shared, name))
    assert len(recordings) == count
    for recording in recordings[::5]:
        times = np.array([m.t for m in recording.messages])
        moving = (times >= recording.onset) & (times <= recording.end)
        found = gaps(palms(recording)[moving], recording)
        rivals = [gap for id, gap in found.items() if id != recording.target]
        assert min(rivals, default=1.0) > KEPT - 4.0 * NOISE
        assert found[recording.target] < 0.12


def test_objects_stand_where_working_hands_never_go(shared):
    recordings = [
        r for part in (True, False) for r in hands_at_work(shared / "hands_at_work", 1, part)
    ]
    assert len(recordings) > 200
    for recording in recordings[::20]:
        assert recording.target is None
        assert recording.messages[-1].t > MIN_SECONDS
        assert min(gaps(palms(recording), recording).values()) > CLEARANCE
