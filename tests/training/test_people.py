"""Nobody is both learned from and judged by; recordings are what they say they are."""

from __future__ import annotations

import numpy as np
import pytest

from datasets import shared_folder
from igrip.objects.catalog import PAPER_OBJECTS
from training.moments import ABSENT, catalog, follow, moments_of
from training.people import KEPT_BACK, LEARNED_FROM, fold, real_reaches, real_recordings, record
from training.worlds import TRIALS, simulate_person


@pytest.fixture(scope="module")
def tables():
    folder = shared_folder()
    if folder is None or not (folder / "wispinski2021").exists():
        pytest.skip("the shared data is not beside the checkout")
    return folder / "wispinski2021"


def test_folds_share_nobody(tables):
    people = {reach.participant for reach in real_reaches(tables)}
    learned = {reach.participant for reach, _ in real_recordings(tables, 0, LEARNED_FROM)}
    kept = {person for person in people if fold(person) == KEPT_BACK}
    assert learned | kept == people
    assert not learned & kept
    assert len(kept) >= 10


def test_a_recording_is_the_same_each_time(tables):
    reach, seed = next(real_recordings(tables, 0, LEARNED_FROM))
    first, again = record(reach, seed), record(reach, seed)
    assert first == again
    moments = moments_of(first, follow(first))
    assert len(moments.target) > 3
    assert (np.diff(moments.part) > 0).all()


def test_simulated_people_reach_for_what_is_there_or_for_nothing():
    recordings = [r for n in range(6) for r in simulate_person(1, n)]
    assert len(recordings) == 6 * TRIALS
    for recording in recordings:
        ids = {id for m in recording.messages for id in m.objects}
        if recording.kind == "absent":
            assert recording.target not in ids
            assert recording.weight == ABSENT
        elif recording.kind == "reach":
            assert recording.target in ids
            assert recording.onset < recording.end < recording.back
        else:
            assert recording.target is None
        names = {p.model for m in recording.messages for p in m.objects.values() if p is not None}
        assert names <= set(catalog())
        assert not names & set(PAPER_OBJECTS)
