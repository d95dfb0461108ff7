"""How familiar a movement is."""

from __future__ import annotations

import json

import numpy as np
import pytest

from igrip.errors import IgripError
from igrip.targets.learned.familiarity import (
    COLUMNS,
    FILE,
    TIME_CONSTANT,
    USED,
    Familiarity,
    FamiliarMovements,
    read_movements,
)
from igrip.targets.learned.features import SHARED

NORMAL = FamiliarMovements(
    np.zeros(len(USED)), np.eye(len(USED)), np.array([0.0, 1.0, 2.0, 3.0, 4.0])
)


def shared(distance):
    """Features at a distance from the centre, along one axis."""
    features = np.zeros(len(SHARED))
    features[COLUMNS[0]] = distance
    return features


@pytest.mark.parametrize(
    ("distance", "p"), [(0.0, 1.0), (1.0, 0.75), (1.5, 0.625), (4.0, 0.0), (9.0, 0.0)]
)
def test_the_share_of_real_frames_that_are_further_out(distance, p):
    assert NORMAL.p_value(shared(distance)) == pytest.approx(p)
    assert NORMAL.p_value(shared(-distance)) == pytest.approx(p)


def test_the_noise_of_the_sensor_is_not_compared():
    features = shared(1.0)
    features[SHARED.index("noise_of_way")] = 7.0
    assert NORMAL.p_value(features) == pytest.approx(0.75)


def test_distances_against_numpy():
    random = np.random.default_rng(1)
    root = random.normal(size=(len(USED), len(USED)))
    centre = random.normal(size=len(USED))
    movements = NORMAL._replace(centre=centre, precision=root @ root.T)
    for _ in range(20):
        features = random.normal(size=len(SHARED))
        off = features[COLUMNS] - centre
        distance = np.sqrt(off @ root @ root.T @ off)
        expected = 1.0 - np.interp(distance, NORMAL.distances, np.linspace(0, 1, 5))
        assert movements.p_value(features) == pytest.approx(expected)


def test_the_mean_over_a_movement_fades():
    familiarity = Familiarity(NORMAL)
    assert familiarity.value is None
    assert familiarity.update(1.0, shared(0.0)) == pytest.approx(1.0)
    assert familiarity.update(1.0 + TIME_CONSTANT, shared(4.0)) == pytest.approx(np.exp(-1.0))
    familiarity.reset()
    assert familiarity.value is None
    assert familiarity.update(9.0, shared(4.0)) == pytest.approx(0.0)


def test_it_does_not_depend_on_the_rate():
    slow, fast = Familiarity(NORMAL), Familiarity(NORMAL)
    for k in range(16):
        slow.update(k / 15, shared(0.0 if k < 8 else 3.0))
    for k in range(121):
        fast.update(k / 120, shared(0.0 if k / 8 < 7.5 else 3.0))
    assert fast.value == pytest.approx(slow.value, abs=0.1)


def test_what_ships_can_be_read():
    movements = read_movements(FILE)
    assert (np.diff(movements.distances) >= 0.0).all()
    assert (np.linalg.eigvalsh(movements.precision) > 0.0).all()


def test_a_file_for_other_features_is_refused(tmp_path):
    content = json.loads(FILE.read_text())
    path = tmp_path / "familiarity.json"
    path.write_text(json.dumps(content | {"features": ["speed"]}))
    with pytest.raises(IgripError, match="made for other features"):
        read_movements(path)
