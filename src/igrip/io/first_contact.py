"""The plausibility check of a stream or recording, on its first messages and now and then.

Units and frames do not change in mid-stream: data that were plausible once are never refused again,
whatever faults make of them later.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from igrip.entities import Hand, ObjectPose
from igrip.io.frames import DeclaredFrame
from igrip.io.plausibility import Finding, Samples, check_samples, refusal
from igrip.observation import Observation

MESSAGES = 64  # that are checked together
EARLY = (8, 16, 32)  # messages after which they are checked, too

Row = tuple[float, tuple[float, ...], tuple[float, ...] | None]


class FirstContact:
    """Collects messages and checks whether their numbers mean what they are taken for.

    Parameters
    ----------
    frame : DeclaredFrame
        What was declared of them; findings name the units in its terms.

    Attributes
    ----------
    findings : list of Finding
        Of the newest check.
    """

    def __init__(self, frame: DeclaredFrame | None = None) -> None:
        self._frame = frame or DeclaredFrame()
        self.findings: list[Finding] = []
        self._was_plausible = False  # over as many messages as are checked together
        self._begin()

    def _begin(self) -> None:
        self._count = 0
        self._times: list[float] = []
        self._hands: defaultdict[str, list[Row]] = defaultdict(list)
        self._objects: defaultdict[str, list[Row]] = defaultdict(list)

    def add(self, message: Observation) -> bool:
        """Add a message with the sender's times; return whether :attr:`findings` are new."""
        if message.is_tick:
            return False
        if self._count >= MESSAGES:
            self._begin()
        for entities, rows in ((message.hands, self._hands), (message.objects, self._objects)):
            for id, entity in entities.items():
                if entity is not None:
                    rows[id].append(_row(message.t, entity))
        self._times.append(message.t)
        self._count += 1
        if self._count not in EARLY and self._count < MESSAGES:
            return False
        self.check()
        return True

    def check(self) -> list[Finding]:
        """Check what was added, at most :data:`MESSAGES`; return the findings."""
        findings = check_samples(
            {id: _samples(rows) for id, rows in self._hands.items()},
            {id: _samples(rows) for id, rows in self._objects.items()},
            self._frame.length_unit, self._frame.time_unit, np.array(self._times),
        )  # fmt: skip
        if self._was_plausible:
            findings = [finding._replace(verdict="remark") for finding in findings]
        elif self._count >= MESSAGES:
            self._was_plausible = refusal(findings) is None
        self.findings = findings
        return findings


def _row(t: float, entity: Hand | ObjectPose) -> Row:
    orientation = entity.orientation if isinstance(entity, ObjectPose) else None
    return t if entity.t is None else entity.t, entity.position, orientation


def _samples(rows: list[Row]) -> Samples:
    unknown = (np.nan,) * 4
    turned = any(q is not None for _, _, q in rows)
    return Samples(
        np.array([t for t, _, _ in rows]),
        np.array([p for _, p, _ in rows]),
        np.array([q or unknown for _, _, q in rows]) if turned else None,
    )
