import numpy as np

from igrip.perception.registration.clusters import cluster_of
from igrip.perception.registration.refused import FIRST, LONGEST, Refusals

IDS = ["a", "b"]


def box(x=0.0, height=0.1, count=200, seed=0):
    """Points in a box of 6 cm on the table, its middle at x."""
    points = np.random.default_rng(seed).uniform(-0.03, 0.03, (count, 3))
    points[:, 2] = (points[:, 2] + 0.03) / 0.06 * height
    points[:, 0] += x
    return cluster_of(points, np.full(count, 0.8))


def test_what_was_tried_in_vain_waits_ever_longer():
    refusals = Refusals()
    assert refusals.allowed(box(), IDS, 0.0) == {"a", "b"}
    times, t = [], 0.0
    while t < 60.0:
        if refusals.allowed(box(seed=round(10 * t)), IDS, t):
            refusals.add(box(), IDS, t)
            times.append(t)
        t += 0.25
    waits = np.diff(times)
    assert waits[0] == FIRST
    assert (np.diff(waits) >= 0).all()
    assert waits[-1] == LONGEST


def test_another_id_or_another_cluster_is_tried_at_once():
    refusals = Refusals()
    refusals.add(box(), IDS, 0.0)
    assert refusals.allowed(box(), [*IDS, "c"], 0.1) == {"c"}
    for other in (box(x=0.03), box(height=0.15), box(count=300)):
        assert refusals.allowed(other, IDS, 0.1) == {"a", "b"}
    refusals.clear()
    assert refusals.allowed(box(), IDS, 0.1) == {"a", "b"}


def test_a_clock_that_steps_back_forgets():
    refusals = Refusals()
    refusals.add(box(), IDS, 10.0)
    assert refusals.allowed(box(), IDS, 1.0) == {"a", "b"}
