"""Candidates of a catalogue's models: declared in objects.toml, or found and kept on disk."""

from __future__ import annotations

import math

import numpy as np
import pytest

import igrip
from grasps.shapes import SHAPES
from igrip.errors import ObjectsError
from igrip.grasps import candidates as module
from igrip.grasps.candidate import Candidate
from igrip.grasps.candidates import candidates_of

CAN = "cylinder:0.033x0.10"
TABLE = """
[[mug.grasps]]
grip = "hook"
part = "handle"
point = [0.07, 0.0, 0.05]
approach = [-2.0, 0.0, 0.0]
closing = [0.1, 1.0, 0.0]
opening = 0.012

[[mug.grasps]]
grip = "pinch"
point = [0.038, 0.0, 0.09]
approach = [0.0, 0.0, -1.0]
closing = [1.0, 0.0, 0.0]
opening = 0.004
weight = 3.0
pivot = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
turn = 3.14159
"""


def load(folder, table):
    SHAPES["mug"]().export(folder / "mug.stl")
    (folder / "objects.toml").write_text(table)
    return igrip.load_objects(folder)


def test_declared_ways_stand_alone(tmp_path):
    for _ in range(2):  # from the mesh, and from the cache
        pinch, hook = candidates_of(load(tmp_path, TABLE)["mug"])
        assert (pinch.grip, pinch.part, pinch.weight) == ("pinch", "declared", 0.75)
        assert pinch.turns == (-3.14159, 3.14159)
        assert (hook.grip, hook.part, hook.weight) == ("hook", "handle", 0.25)
        assert hook.approach == pytest.approx([-1, 0, 0])
        assert hook.closing == pytest.approx([0, 1, 0])
        assert hook.turns == (0.0, 0.0)


@pytest.mark.parametrize(
    ("wrong", "problem"),
    [
        ('grip = "claw"', "there is no grip 'claw'"),
        ("closing = [1.0, 0.0, 0.0]\nopening = 0.012", "two directions across"),
        ("opening = 3.0", "opening"),
        ("opening = 0.01\nturn = 1.0", "turn needs an axis"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, wrong, problem):
    first = TABLE.split("[[mug.grasps]]")[1]
    key = wrong.split(" = ")[0]
    lines = [line for line in first.splitlines() if line.split(" = ")[0] not in (key, "opening")]
    rest = [] if "opening" in wrong else ["opening = 0.01"]
    with pytest.raises(ObjectsError, match=problem):
        load(tmp_path, "\n".join(["[[mug.grasps]]", *lines, *rest, *wrong.splitlines()]))


def test_found_once_and_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("IGRIP_CACHE_DIR", str(tmp_path))
    module.cache_directory.cache_clear()
    try:
        first = candidates_of(igrip.load_objects(CAN)[CAN])
        monkeypatch.setattr(module, "build_candidates", lambda model: pytest.fail("built again"))
        again = candidates_of(igrip.load_objects(CAN)[CAN])
    finally:
        monkeypatch.undo()
        module.cache_directory.cache_clear()
    assert len(first) == len(again) > 1
    for one, other in zip(first, again, strict=True):
        for name in Candidate._fields:
            assert np.array_equal(getattr(one, name), getattr(other, name)), name
        assert isinstance(other.grip, str)
        assert math.isfinite(other.weight)
