"""The whole estimator against the oracle, over simulated reaches for real and simple objects."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import igrip
from oracle import pipeline
from support import BOX, CAN, PAPER, oracle_mesh, random_turn, reach, run, scene_of_shapes

SINGLES = ("impacts", "distance_derivative", "distance", "future_distance")
ESTIMATORS = ("paper", "repaired", *SINGLES)
TIGHT = {"rel": 1e-9, "abs": 1e-12}


def compare(messages, catalog, names, wanted, distances=("vertex",)):
    """Compare every estimator with the oracle at the wanted messages; return the count."""
    mesh_of = {name: oracle_mesh(catalog[name]) for name in names}
    metrics = pipeline.run(messages, mesh_of, wanted)
    for targets, distance in itertools.product(ESTIMATORS, distances):
        expected = {key: pipeline.decide(result, distance) for key, result in metrics.items()}
        config = igrip.Config(targets=targets, cues={"distance": distance})
        estimator = igrip.Estimator(catalog, config)
        for index, message in enumerate(messages):
            intentions = estimator.update(igrip.Observation(**message))
            for intention in intentions:
                result = expected.get((index, intention.hand))
                if result is not None:
                    compare_one(intention, result, targets)
    return len(metrics)


def compare_one(intention, result, targets):
    ids, scores = result["ids"], intention.scores
    assert list(scores) == ids
    for metric in SINGLES:
        ours = [scores[id][metric] for id in ids]
        assert ours == pytest.approx(result["scores"][metric], **TIGHT), metric
    ours = [scores[id]["global"] for id in ids]
    assert ours == pytest.approx(result["scores"][targets], **TIGHT)
    index = result["targets"][targets]
    assert intention.target == (None if index is None else ids[index])
    assert intention.grip == result["grips"][targets]
    if index is None:
        assert intention.confidence is None
    else:
        assert intention.confidence == pytest.approx(result["scores"][targets][index], **TIGHT)
    assert intention.probability is None


def ycb_scene(rng):
    """Two hands going for two of the paper's objects, all turned at random; one is carried."""
    places = [(0.35, 0.25, 0.10), (0.40, 0.08, 0.05), (0.38, -0.10, 0.09), (0.33, -0.28, 0.12)]
    objects = {
        f"object {k}": (name, place, random_turn(rng), (0.2, 0.0, 0.1) if k == 3 else (0.0,) * 3)
        for k, (name, place) in enumerate(zip(PAPER, places, strict=True))
    }
    hands = {
        "left": ((0.0, 0.25, 0.0), np.add(places[0], [0.0, 0.0, 0.03])),
        "right": ((0.0, -0.25, 0.0), places[2]),
    }
    return reach(rng, objects, hands)


def test_real_objects_two_hands(ycb):
    messages = ycb_scene(np.random.default_rng(1))
    measured = [k for k, message in enumerate(messages) if "hands" in message]
    wanted = set(measured[12::4])  # the oracle takes its time
    assert compare(messages, ycb, PAPER, wanted.__contains__) >= 8


@pytest.mark.parametrize(("seed", "moving"), [(3, False), (4, True), (5, True)])
def test_simple_objects(shapes, seed, moving):
    messages = scene_of_shapes(np.random.default_rng(seed), moving=moving)
    wanted = set(range(seed, len(messages), 2))
    assert compare(messages, shapes, (BOX, CAN), wanted.__contains__, ("vertex", "surface")) >= 10


def test_one_object_is_compared_with_a_fixed_length(shapes):
    rng = np.random.default_rng(6)
    objects = {"only": (CAN, (0.3, 0.1, 0.0), random_turn(rng), (0.0, 0.0, 0.0))}
    messages = reach(rng, objects, {"hand": ((0, 0, 0), (0.3, 0.1, 0.04))}, rest=0.1, duration=0.5)
    assert compare(messages, shapes, (CAN,), lambda index: index % 4 == 0) >= 5


def test_metrics_behind_the_scores(shapes):
    """Ray counts exactly, distances to 1e-9: the scores alone could hide a common factor."""
    messages = scene_of_shapes(np.random.default_rng(7), moving=True)
    mesh_of = {name: oracle_mesh(shapes[name]) for name in (BOX, CAN)}
    expected = pipeline.run(messages, mesh_of, lambda index: index % 2 == 0)
    estimator = igrip.Estimator(shapes)
    compared = hits = 0
    for index, message in enumerate(messages):
        run([message], shapes, estimator=estimator)
        for id, track in estimator.hands.items():
            result = expected.get((index, id))
            if result is None or "hands" not in message or id not in message["hands"]:
                continue
            [geometry] = estimator.scene.measure([track.motion], estimator.objects)
            assert track.motion.coefficients == pytest.approx(result["coefficients"], rel=1e-9)
            assert track.motion.position == pytest.approx(result["position"], rel=1e-12)
            assert track.motion.speed == pytest.approx(result["speed"], rel=1e-9)
            assert track.motion.window_peak_speed == (
                None if result["peak"] is None else pytest.approx(result["peak"], rel=1e-9)
            )
            for k, metrics in enumerate(result["metrics"]):
                assert metrics["clearest"] > 1e-9  # no ray of this scene grazes an edge
                assert geometry.hits[k] == metrics["hits"]
                for name in ("vertex", "surface", "future_vertex", "future_surface", "centre"):
                    assert getattr(geometry, name)[k] == pytest.approx(metrics[name], rel=1e-9)
                assert geometry.centre_rate[k] == pytest.approx(metrics["centre_rate"], **TIGHT)
                assert geometry.axial[k] ** 2 == pytest.approx(metrics["axial"] ** 2, abs=1e-9)
                hits += metrics["hits"]
            compared += 1
    assert compared >= 10
    assert hits > 100
