"""The field's methods: each does what its paper says, on reaches that suit it."""

from __future__ import annotations

import numpy as np
import pytest

from igrip.targets.learned.reach_library import (
    AccumulatedLikelihood,
    ReachCoordinates,
    library,
    log_volume,
)
from reaching import SPREAD, TWO, at, intentions_of, reach_messages

LEARNED = ("gaussians", "mixtures", "templates")


@pytest.mark.parametrize("name", ["nearest", "heading", *LEARNED])
@pytest.mark.parametrize("goal", ["left", "right"])
def test_objects_apart_are_told_on_the_way(shapes, name, goal):
    messages, onset, end = reach_messages(SPREAD[goal], SPREAD, noise=0.001)
    answers = intentions_of(messages, shapes, name)
    assert at(answers, onset + 0.7 * (end - onset)).target == goal
    assert all(i.probability is None for i in answers)


@pytest.mark.parametrize("name", [*LEARNED, "heading"])
def test_a_resting_hand_has_no_target(shapes, name):
    messages, onset, _ = reach_messages(SPREAD["left"], SPREAD)
    assert at(intentions_of(messages, shapes, name), onset - 0.1).target is None


def test_nearest_is_by_the_surface(shapes):
    messages, onset, end = reach_messages(TWO["far"], TWO, lift=0.1)
    answers = intentions_of(messages, shapes, "nearest")
    assert at(answers, onset + 0.4 * (end - onset)).target == "near"
    assert at(answers, end).target == "far"


@pytest.mark.parametrize("name", LEARNED)
@pytest.mark.parametrize("rate", [15.0, 120.0])
def test_a_faster_sensor_gives_much_the_same_answer(shapes, name, rate):
    told = []
    for r in (30.0, rate):
        messages, onset, end = reach_messages(SPREAD["left"], SPREAD, r, rest=0.6, lasts=1.2)
        answers = intentions_of(messages, shapes, name)
        told.append([at(answers, onset + p * (end - onset)).target for p in (0.6, 0.8, 1.0)])
    assert told[0] == told[1]


def test_a_witness_counts_time_and_not_samples():
    class Seen:
        def __init__(self, ids):
            self.objects = [type("PlacedObject", (), {"id": id}) for id in ids]

    def after(passed, elapsed):
        return ReachCoordinates(elapsed, passed, np.empty(0), np.empty(0))

    slow, fast = AccumulatedLikelihood(1 / 30), AccumulatedLikelihood(1 / 30)
    fit = np.array([0.0, -0.3])
    for k in range(10):
        a = slow.add(Seen("ab"), after(1 / 30, k / 30), fit)
    for k in range(40):
        b = fast.add(Seen("ab"), after(1 / 120, k / 120), fit)
    assert a == pytest.approx(b)
    assert a == pytest.approx(np.exp([0.0, -3.0]) / np.exp([0.0, -3.0]).sum())
    late = slow.add(
        Seen("abc"), after(1 / 30, 10 / 30), np.zeros(3)
    )  # c appears: no likelier than the least
    assert late[2] == pytest.approx(late[1])


def test_the_library_says_where_it_comes_from():
    assert "folds of people" in library()["provenance"]["real"]


@pytest.mark.parametrize("name", ["nearest", "heading", *LEARNED, "bayes"])
def test_no_object_and_one(shapes, name):
    for objects in ({}, {"left": SPREAD["left"]}):
        messages, _, end = reach_messages(SPREAD["left"], objects)
        last = at(intentions_of(messages, shapes, name), end - 0.1)
        assert last.target == ("left" if objects else None)


def test_densities_over_a_reach_are_made_densities_in_space():
    """A Gaussian over progress and deviation, made a density in space, integrates to one."""
    step = 0.01
    progress, deviation = np.meshgrid(np.arange(-1, 2, step), np.arange(0.015, 1.0, step))
    place = np.column_stack([progress.ravel(), deviation.ravel()])
    off = (place - [0.5, 0.3]) / [0.1, 0.05]
    density = np.exp(-0.5 * (off**2).sum(axis=1)) / (2 * np.pi * 0.1 * 0.05)
    for length in (0.2, 1.0, 3.0):
        seen = ReachCoordinates(0.0, 0.0, place, np.full(len(place), length))
        in_space = density / (2 * np.pi * np.exp(log_volume(seen)))
        rings = 2 * np.pi * (place[:, 1] * length) * (step * length) ** 2
        assert (in_space * rings).sum() == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("name", LEARNED)
def test_a_hand_that_has_stopped_keeps_what_was_told(shapes, name):
    messages, _, end = reach_messages(SPREAD["left"], SPREAD, hold=1.0)
    assert intentions_of(messages, shapes, name)[-1].target == "left"
    assert messages[-1]["t"] > end + 0.9
