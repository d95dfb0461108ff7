"""10⁵ broken messages: each is parsed or raises ObservationError, and never anything else."""

from __future__ import annotations

import json
import random

import pytest

import igrip
from igrip import Observation, ObservationError
from mutate import damaged, damaged_bytes, grown, sample
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
