"""A story of intentions that tests send through outputs."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import igrip
from igrip.intention import Commitment, Intention
from igrip.runtime.envelope import Sequencer

LEASE = Commitment(target="mug", grip="palmar", since=1.0, valid_until=1.15)
STORY = (
    Intention(t=0.9, hand="right", status="idle"),
    Intention(
        t=1.0, hand="right", status="reaching", target="mug", grip="palmar", confidence=0.875,
        probability={"mug": 0.875, "none": 0.125}, time_to_contact=0.5, contact=(0.25, 0.5, 0.125),
        commitment=LEASE,
    ),
    Intention(t=1.1, hand="right", status="lost", reason="not measured"),
)  # fmt: skip
PERMITTED = (0.0, 0.125, 0.0)  # s that are left when it is sent, below


def envelopes():
    """Yield the story, each with a clock that stands 0.025 s after its message arrived."""
    sequencer = Sequencer(lambda: 0.0)
    for intention in STORY:
        wrapped = sequencer.wrap(intention, intention.t)
        yield replace(wrapped, now=lambda t=intention.t: t + 0.025)


class FakeLoop:
    """What an output needs of a loop."""

    def __init__(self, lease=0.15):
        self.session = "0123456789ab"
        self.announced, self.warnings = [], []
        self.announce, self.warn = self.announced.append, self.warnings.append
        self.estimator = SimpleNamespace(config=igrip.Config(commitment={"lease_duration": lease}))
