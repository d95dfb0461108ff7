"""An object that the estimator refuses is left out alone, whatever the ids are."""

from __future__ import annotations

import pytest

from igrip import Estimator, Observation
from igrip.runtime.clock_sync import SenderClock
from igrip.runtime.loop import Loop, Sender
from support import BOX, CAN, message, pose


@pytest.mark.parametrize(
    ("refused", "kept"),
    [("a.b", "a"), ("a", "a.b"), ("a[0]", "a"), ("", " "), ("☕.", "☕"), ("x" * 81, "x" * 82)],
)
def test_another_object_with_a_similar_id_stays(shapes, refused, kept):
    estimator = Estimator(shapes)
    loop = Loop(estimator, SenderClock())
    first = {refused: pose((0, 0, 0), model=BOX), kept: pose((1, 0, 0), model=BOX)}
    second = {refused: pose((0, 0, 0), model=CAN), kept: pose((2, 0, 0), model=BOX)}
    answers = []
    sender = Sender(reply=lambda error: answers.append(error.problem))
    for t, objects in ((1.0, first), (2.0, second)):
        loop.submit(Observation(**message(t, None, objects)), sender)
        loop.step(0.0)
    [problem] = answers
    assert "the id is bound to" in problem
    moved = {placed.id: placed.translation[0] for placed in estimator.objects}
    assert moved[kept] > 1.9  # it is smoothed
    assert estimator.inputs()["objects"][refused]["model"] == BOX
