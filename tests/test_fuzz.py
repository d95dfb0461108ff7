"""10⁵ broken messages: each is parsed or raises ObservationError, and never anything else."""

from __future__ import annotations

import json
import random

import pytest

import igrip
from igrip import Observation, ObservationError
from random_damage import damaged, damaged_bytes, grown, sample
from support import BOX, CAN

COUNT = 10_000  # of each of ten kinds
MODELS = [BOX, CAN, "unheard of"]


def messages(kind, seed):
    """Yield how to make one broken message after the other."""
    rng = random.Random(f"{kind} {seed}")
    t = 0.0
    for _ in range(COUNT):
        t += rng.choice((0.0, 0.01, 0.033, 0.4))
        plain = sample(rng, t, MODELS)
        if kind == "bytes":
            line = damaged_bytes(rng, json.dumps(plain).encode())
            yield lambda line=line: Observation.from_json(line)
        elif kind == "text":
            line = damaged_bytes(rng, json.dumps(plain).encode())
            line = line.decode("utf-8", rng.choice(("replace", "surrogateescape")))
            yield lambda line=line: Observation.from_json(line)
        elif kind == "structure":
            broken = damaged(rng, plain)
            yield lambda broken=broken: Observation.from_dict(broken)
        elif kind == "arguments":
            broken = damaged(rng, plain)
            broken = broken if isinstance(broken, dict) else {"t": broken}
            broken = {str(key): value for key, value in broken.items()}  # Python's own rule
            yield lambda broken=broken: Observation(**broken)
        else:
            broken = grown(rng)
            yield lambda broken=broken: Observation.from_dict(broken)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("kind", ["bytes", "text", "structure", "arguments", "nonsense"])
def test_broken_messages(shapes, kind, seed):
    parsed, refused, rejected = 0, [], []
    for number, make in enumerate(messages(kind, seed)):
        if number % 100 == 0:  # a message from the far future would end every later one
            estimator = igrip.Estimator(shapes)
        try:
            observation = make()
        except ObservationError as error:
            refused.append(error.field)
            continue
        parsed += 1
        before = str(estimator.inputs())  # with its NaN
        try:
            intentions = estimator.update(observation)
        except ObservationError as error:
            rejected.append(error.field)
            intentions = []
            unchanged = str(estimator.inputs()) == before
            assert unchanged, rejected[-1]
        for intention in intentions:
            assert intention.hand in observation.hands or intention.status == "lost"
    assert parsed + len(refused) == COUNT
    assert len(refused) > COUNT / 5
    assert all(refused)
    assert all(field == "t" or field.endswith(".model") for field in rejected)
    if kind != "nonsense":
        assert parsed > COUNT / 10
        assert rejected


@pytest.mark.parametrize("seed", range(8))
def test_more_things_than_there_is_room_for(shapes, seed):
    """Ids come and go, with and without their model, over pauses that let them be forgotten."""
    rng, t, rejected = random.Random(seed), 0.0, 0
    config = igrip.Config(tracking={"max_objects": 1 + seed % 3, "max_hands": 1 + seed % 2})
    estimator = igrip.Estimator(shapes, config)
    for _ in range(1500):
        t += rng.choice((0.0, 0.03, 0.1, 0.4, 2.5))
        plain = {"t": t, "hands": {}, "objects": {}}
        for id in rng.sample("abcd", rng.randrange(4)):
            where = [rng.uniform(-0.1, 0.1) for _ in range(3)]
            age = rng.choice((0.0, 0.0, 0.1, 0.5, 3.0, -1.0))
            entity = {"position": where, "t": max(0.0, t - age)}
            plain["hands"][id] = rng.choice((entity, entity, None))
            entity = {**entity, "orientation": [0, 0, 0, 1], "static": rng.random() < 0.3}
            if rng.random() < 0.8:
                entity["model"] = MODELS["abcd".index(id) % 3]
            plain["objects"][id] = rng.choice((entity, entity, None))
        try:
            told = estimator.update(Observation(**plain))
        except ObservationError:
            rejected += 1
            continue
        report = estimator.inputs()
        assert len(report["hands"]) <= config.tracking.max_hands
        assert len(report["objects"]) <= config.tracking.max_objects
        usable = {id for id, entry in report["objects"].items() if entry["usable"]}
        assert {body.id for body in estimator.objects} == usable
        for intention in told:
            assert set(intention.scores) <= usable
            assert intention.target is None or intention.target in usable
            assert (intention.status in ("idle", "reaching")) or not intention.scores
            assert intention.to_json()
    assert 50 < rejected < 1000


def test_what_was_parsed_can_be_written_and_read_again():
    rng = random.Random(3)
    written = 0
    for number in range(3000):
        line = damaged_bytes(rng, json.dumps(sample(rng, 0.01 * number, MODELS)).encode())
        if b"\\ud" in line:
            continue  # half a pair of surrogates: test_observation has a test of its own
        try:
            observation = Observation.from_json(line)
        except ObservationError:
            continue
        written += 1
        assert Observation.from_json(observation.to_json()) == observation
    assert written > 300
