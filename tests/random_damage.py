"""Random damage: to bytes of JSON, and to the plain structures that messages are made of."""

from __future__ import annotations

import json
import random

from support import UPRIGHT

ATOMS = [
    None, True, False, 0, 1, -1, 0.0, -0.0, 0.5, 1e300, -1e300, 1e-320, 10**400, float("nan"),
    float("inf"), -float("inf"), "", "none", "x", "\x00", "igrip/1", b"", b"x", (), [], {}, set(),
    1j, range(3), object(), [0, 0, 0], [0, 0, 0, 1], (0.1, 0.2, 0.3), [[0, 0, 0]], {"t": 1},
    {1: 2}, int, len, frozenset({1}), [None, None, None], "ключ", ["0", "0", "0"],
]  # fmt: skip
KEYS = ["t", "hands", "objects", "schema", "position", "orientation", "model", "static", "std",
        "score", "source", "landmarks", "right", "left", "mug", "can", "none", "", "x"]  # fmt: skip
JUNK = [b"\x00", b"\xff", b'"', b"{", b"}", b"[", b"]", b",", b":", b"e", b"E", b"-", b".", b"9",
        b"NaN", b"Infinity", b"null", b"true", b"1e999", b"\\ud800", b"\\u0000", b" ", b"\n",
        b'"t":', b"[[[[", b"0.1", b"\xf0\x9f"]  # fmt: skip


def sample(rng: random.Random, t: float, models: list[str]) -> dict:
    """Return a valid message with a bit of everything."""
    near = lambda: [rng.uniform(-0.3, 0.3) for _ in range(3)]  # noqa: E731
    message = {"schema": "igrip/1", "t": t, "hands": {}, "objects": {}}
    for id in ("right", "left")[: rng.randint(0, 2)]:
        message["hands"][id] = hand = {"position": near()}
        if rng.random() < 0.3:
            hand |= {"t": max(0.0, t - rng.uniform(-0.1, 0.4)), "std": 0.01, "score": 0.5}
        if rng.random() < 0.1:
            hand |= {"landmarks": [near(), near()], "orientation": UPRIGHT, "source": "s"}
    for id in ("mug", "can", "box")[: rng.randint(0, 3)]:
        message["objects"][id] = {
            "model": models[len(id) % len(models)], "position": near(), "orientation": UPRIGHT,
        }  # fmt: skip
        if rng.random() < 0.2:
            message["objects"][id] |= {"static": True, "t": t, "std": [0.1, 0.1, 0.1]}
    if rng.random() < 0.1:
        message["hands"]["right"] = None
    return message


def damaged_bytes(rng: random.Random, line: bytes) -> bytes:
    """Return a line with some bytes changed, cut, doubled, swapped or put in."""
    for _ in range(rng.choice((1, 1, 1, 2, 5))):
        at = rng.randrange(len(line) + 1)
        kind = rng.randrange(6)
        if kind == 0:
            line = line[:at] + bytes([rng.randrange(256)]) + line[at + 1 :]
        elif kind == 1:
            line = line[:at] + line[at + rng.randrange(1, 9) :]
        elif kind == 2:
            line = line[:at] + rng.choice(JUNK) + line[at:]
        elif kind == 3:
            line = line[:at] + rng.choice(JUNK) + line[at + rng.randrange(4) :]
        elif kind == 4:
            line = line[:at]
        else:
            end = at + rng.randrange(1, 30)
            line = line[:at] + line[at:end] + line[at:end] + line[end:]
    return line


def damaged(rng: random.Random, value, depth=0):
    """Return a structure with one part of it replaced, renamed, dropped or added."""
    if depth == 0:
        value = json.loads(json.dumps(value))
    if isinstance(value, dict) and value and rng.random() < 0.85:
        key = rng.choice(list(value))
        kind = rng.random()
        if kind < 0.7:
            value[key] = damaged(rng, value[key], depth + 1)
        elif kind < 0.8:
            value[rng.choice(KEYS)] = value.pop(key)
        elif kind < 0.9:
            del value[key]
        else:
            value[rng.choice(KEYS)] = rng.choice(ATOMS)
        return value
    if isinstance(value, list) and value and rng.random() < 0.6:
        at = rng.randrange(len(value))
        value[at] = damaged(rng, value[at], depth + 1)
        return value
    return rng.choice(ATOMS)


def grown(rng: random.Random, depth=0):
    """Return a structure that was never a message."""
    kind = rng.random()
    if depth > 3 or kind < 0.4:
        return rng.choice(ATOMS)
    if kind < 0.8:
        return {rng.choice(KEYS): grown(rng, depth + 1) for _ in range(rng.randrange(4))}
    return [grown(rng, depth + 1) for _ in range(rng.randrange(4))]


def garbled(message, rng):
    """Return a message as bytes or text, with some bytes replaced, or noise."""
    data = bytearray(message)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(data))
        data[at : at + rng.randint(0, 6)] = rng.choice(JUNK)
    if rng.random() < 0.2:
        data = bytearray(rng.randbytes(rng.randint(0, 80)))
    return bytes(data) if rng.random() < 0.5 else data.decode("latin-1")
