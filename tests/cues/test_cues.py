"""Each cue on its own, against the oracle's confidences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frames import geometry, motion
from igrip.cues import CUES, CueConfig
from oracle import scores

COUNTS = st.lists(st.integers(0, 360), min_size=1, max_size=6)
LENGTHS = st.lists(st.floats(0.0, 3.0), min_size=1, max_size=6)
SPREADS = st.one_of(st.just(float("nan")), st.floats(1e-3, 2.0))


def score(name, geometry, moving=None, **config):
    return CUES.get(name).score(moving or motion(), geometry, CueConfig(**config))


@given(COUNTS)
def test_impacts(hits):
    ours = score("impacts", geometry(len(hits), hits=np.array(hits)))
    assert ours == pytest.approx(scores.impacts(hits), rel=1e-12)
    assert ours.sum() == pytest.approx(1.0 if sum(hits) else 0.0)


@pytest.mark.parametrize("hits", [[1], [0, 1, 0], [0, 0]])
def test_a_single_ray_is_all_of_the_rays(hits):
    assert score("impacts", geometry(len(hits), hits=np.array(hits))).tolist() == hits


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("part", "expected"),
    [(1.0 + 1e-12, 1.0), (1.0, 1.0), (1.0 - 1e-12, 1.0 - 1e-12), (1.0 + 1e-6, 1.0 + 1e-6)],
)
def test_rounding_beyond_one_is_cut_off_and_a_moving_object_is_not(sign, part, expected):
    ours = score("distance_derivative", geometry(1, centre_rate=[-sign * part]), motion(1.0))
    assert ours.tolist() == [sign * expected]


def test_distance_derivative_begins_at_the_minimal_speed():
    frame = geometry(2, centre_rate=[-0.25, 0.25])
    assert score("distance_derivative", frame, motion(0.5), min_speed=0.5).tolist() == [0.5, -0.5]


@given(LENGTHS, st.floats(0.03, 3.0))
def test_distance_derivative(rates, speed):
    rates = np.array(rates) - 1.5
    ours = score("distance_derivative", geometry(len(rates), centre_rate=rates), motion(speed))
    assert ours == pytest.approx(scores.distance_derivative(rates, speed), rel=1e-12)
    # the object that is approached fastest scores best: the paper's sign would choose the other
    assert np.argmax(ours) == np.argmin(rates)


@pytest.mark.parametrize("speed", [0.0, 0.01, 0.0299])
def test_distance_derivative_of_a_resting_hand(speed):
    ours = score("distance_derivative", geometry(centre_rate=[-0.1, 0.1, 0.0]), motion(speed))
    assert ours.tolist() == [0.0, 0.0, 0.0]


def test_distance_derivative_without_a_least_speed_does_not_divide_by_zero():
    ours = score(
        "distance_derivative", geometry(centre_rate=[-0.1, 0.1, 0.0]), motion(0.0), min_speed=0.0
    )
    assert ours.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("name", ["distance", "future_distance"])
@pytest.mark.parametrize("kind", ["vertex", "surface"])
@given(lengths=LENGTHS, spread=SPREADS)
def test_distances(name, kind, lengths, spread):
    column = kind if name == "distance" else f"future_{kind}"
    frame = geometry(len(lengths), spread=spread, **{column: lengths})
    ours = score(name, frame, distance=kind, default_spread=0.7)
    d_max = 0.7 if np.isnan(spread) else spread
    assert ours == pytest.approx([1.0 - min(d / d_max, 1.0) for d in lengths], abs=1e-12)
    assert ((ours >= 0.0) & (ours <= 1.0)).all()
    assert ours[np.argmin(lengths)] == ours.max()  # the nearest scores best


@pytest.mark.parametrize("spread", [0.0, 1e-9, np.nan])
def test_objects_in_one_place_are_compared_with_a_fixed_length(spread):
    ours = score("distance", geometry(2, vertex=[0.1, 0.3], spread=spread), default_spread=0.5)
    assert ours == pytest.approx([0.8, 0.4])


@pytest.mark.parametrize("name", ["impacts", "distance_derivative", "distance", "future_distance"])
def test_no_objects_no_scores(name):
    assert score(name, geometry(0)).shape == (0,)


@pytest.mark.parametrize("name", ["impacts", "distance_derivative", "distance", "future_distance"])
def test_a_cue_does_not_change_its_input(name):
    arrays = {"hits": [3, 1, 0], "centre_rate": [-0.1, 0.2, 0.3], "spread": 0.5,
              "vertex": [0.1, 0.2, 0.9], "future_vertex": [0.1, 0.2, 0.9]}  # fmt: skip
    frame = geometry(**arrays)
    first = score(name, frame)
    first[:] = 99.0
    for key, value in arrays.items():
        assert np.asarray(getattr(frame, key)).tolist() == np.asarray(value).tolist()
