"""Scenes of two hands: who holds what, and that things are where the hands that hold them are."""

from __future__ import annotations

import math

import numpy as np
import pytest

import igrip
from igrip.io.datasets.dataset import Dataset
from igrip.lab.simulation.movement import draw_habits
from igrip.lab.simulation.parameters import cohort_parameters
from igrip.lab.simulation.table import models_by_id
from igrip.lab.simulation.two_hands import BOX, BOX_ID, KINDS, OTHER, draw_scene
from igrip.lab.simulation.two_hands_cohort import OBJECTS, simulate_two_hands

COHORT = cohort_parameters()


@pytest.fixture(scope="module")
def catalog():
    return igrip.load_objects(*OBJECTS)


@pytest.fixture(scope="module")
def scenes(catalog):
    models = {**models_by_id(catalog), BOX_ID: catalog[BOX]}

    def draw(kind, seed):
        random = np.random.default_rng([seed, KINDS.index(kind)])
        return draw_scene(kind, models, COHORT, draw_habits(COHORT.person, random), random)

    return {kind: [draw(kind, seed) for seed in range(5)] for kind in KINDS}


def test_who_takes_part(scenes):
    for kind, drawn in scenes.items():
        for scene in drawn:
            assert (OTHER in scene.palms) == (kind == "handover")
            targets = [reach.target for reach in scene.reaches]
            if kind == "lift":
                assert len(targets) == 2
                assert len(set(targets)) == 1
            elif kind == "each":
                assert len(set(targets)) == 2
                assert BOX_ID not in targets


def test_what_is_passed_stays_with_the_palm_that_holds_it(scenes):
    for scene in scenes["pass"] + scenes["handover"]:
        giver, receiver = scene.holds
        assert giver.object == receiver.object
        assert receiver.since < giver.until < scene.times[-1]
        poses = scene.moving[giver.object]
        places = np.array([poses(t)[1] for t in scene.times.tolist()])
        for hold, end in ((giver, giver.until), (receiver, math.inf)):
            begin = hold.since if hold is giver else giver.until
            while_held = (scene.times >= begin) & (scene.times < end)
            offset = (places - scene.palms[hold.hand])[while_held]
            assert np.ptp(offset, axis=0).max() < 0.02  # sway and tremor alone


def test_it_does_not_jump(scenes):
    for drawn in scenes.values():
        for scene in drawn:
            for poses in scene.moving.values():
                places = np.array([poses(t)[1] for t in scene.times.tolist()])
                steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
                assert steps.max() * COHORT.protocol.rate < 3.0  # m/s


def test_what_another_hand_held_first_is_free_when_it_lets_go(scenes):
    for scene in scenes["pass"] + scenes["handover"]:
        giver, receiver = scene.holds
        assert scene.free_at(receiver.hand, receiver.object) == giver.until
        assert scene.free_at(giver.hand, giver.object) is None
        both = 0.5 * (receiver.since + giver.until)
        assert scene.held_before(receiver.hand, receiver.object, both)
        assert not scene.held_before(giver.hand, giver.object, both)
        assert not scene.held_before(receiver.hand, receiver.object, giver.until)
    for scene in scenes["lift"]:
        for hold in scene.holds:
            assert not scene.held_before(hold.hand, hold.object, scene.times[-1])


def test_the_dataset(catalog, tmp_path):
    steps = list(simulate_two_hands(tmp_path / "two", catalog, COHORT, participants=1, scenes=4))
    assert steps[-1] == (4, 4)
    dataset = Dataset.open(tmp_path / "two")
    assert dataset.objects == OBJECTS
    assert {trial.movement for trial in dataset.trials} == set(KINDS)
    for trial in dataset.trials:
        passed = trial.movement in ("pass", "handover")
        messages = list(dataset.observations(trial))
        assert trial.onset_s < trial.end_s < messages[-1].t
        assert ("free_s" in trial.extra) == passed
        assert any(trial.hand in message.hands for message in messages)
