"""Snapshots: the rays are those that were counted."""

from __future__ import annotations

import numpy as np

from igrip import Config, Estimator, Observation, load_objects
from igrip.viewer.snapshot import rays_of, take_snapshot
from moments import demo_moments


def test_rays_are_those_that_were_counted():
    moment = demo_moments(load_objects("ycb"))[-1]
    for hand in moment.hands:
        if hand.motion is None or hand.target is None or hand.intention.status != "reaching":
            continue
        geometry = moment.scene.measure([hand.motion], moment.objects)[0]
        index = [placed.id for placed in moment.objects].index(hand.target.id)
        hits, misses = rays_of(moment.scene, hand)
        assert len(hits) == geometry.hits[index] > 20
        assert len(hits) + len(misses) == 360
        # every impact lies on the mesh: no further from a vertex than its longest edge
        model = hand.target.model
        local = (hits[:, 1] - hand.target.translation) @ hand.target.rotation
        away = np.linalg.norm(local[:, None] - model.vertices[None], axis=2).min(axis=1)
        corners = model.vertices[model.faces]
        assert away.max() < np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()


def test_it_knows_which_hands_a_device_assists(shapes):
    estimator = Estimator(shapes, Config(commitment={"assisted": ("right",)}))
    hands = {"right": {"position": [0, 0, 0]}, "left": {"position": [0.5, 0, 0]}}
    estimator.update(Observation(t=0.0, hands=hands))
    shown = {hand.intention.hand: hand.assisted for hand in take_snapshot(estimator).hands}
    assert shown == {"right": True, "left": False}
