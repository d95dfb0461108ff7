"""Where a session stands: what the events of its journal add up to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from igrip.experiment.plan import Plan, PlannedTrial


class AttemptState(StrEnum):
    """What became of an attempt at a trial."""

    RECORDING = "recording"
    RECORDED = "recorded"
    REPEATED = "repeated"  # recorded, and done again
    WRONG = "wrong"  # recorded, not done as told, not done again
    INTERRUPTED = "interrupted"  # by a crash or a lost camera; nothing of it is in the dataset


@dataclass(frozen=True)
class Attempt:
    """One attempt at a trial.

    Attributes
    ----------
    trial, attempt : int
        Number of the trial in the plan, and of the attempt at it, both from 1.
    state : AttemptState
        What became of it.
    comment : str
        Of the experimenter.
    """

    trial: int
    attempt: int
    state: AttemptState
    comment: str = ""

    @property
    def counts(self) -> bool:
        """Whether the trial needs no further attempt."""
        return self.state in (AttemptState.RECORDED, AttemptState.WRONG)


def recording_name(participant: str, attempt: Attempt, camera: str) -> str:
    """Return the name of the recording of an attempt by one camera."""
    again = f"-{attempt.attempt}" if attempt.attempt > 1 else ""
    return f"{participant}_t{attempt.trial:03d}{again}_{camera}"


class SessionProgress:
    """The attempts at a participant's trials.

    Parameters
    ----------
    plan : Plan
        Of the participant.
    events : iterable of mapping
        Of the journal, in order.
    """

    def __init__(self, plan: Plan, events: Iterable[Mapping[str, Any]] = ()) -> None:
        self._plan = plan
        self.attempts: list[Attempt] = []
        self.breaks_after: set[int] = set()  # trials after which there was a break
        for event in events:
            self.add(event)

    def add(self, event: Mapping[str, Any]) -> None:
        """Take one more event into account; events of other kinds change nothing."""
        name = event["event"]
        if name == "trial_started":
            trial = int(event["trial"])
            number = 1 + sum(one.trial == trial for one in self.attempts)
            self.attempts.append(Attempt(trial, number, AttemptState.RECORDING))
        elif name == "trial_recorded":
            self._change(state=AttemptState.RECORDED)
        elif name == "trial_interrupted":
            self._change(state=AttemptState.INTERRUPTED)
        elif name == "trial_marked":
            self._change(state=AttemptState(event["as"]))
        elif name == "commented":
            before = self.attempts[-1].comment if self.attempts else ""
            self._change(comment="; ".join(filter(None, (before, str(event["text"])))))
        elif name == "break_ended":
            self.breaks_after.add(int(event["after"]))

    def _change(self, **fields: Any) -> None:
        if self.attempts:
            self.attempts[-1] = replace(self.attempts[-1], **fields)

    @property
    def last(self) -> Attempt | None:
        """The newest attempt."""
        return self.attempts[-1] if self.attempts else None

    @property
    def done(self) -> set[int]:
        """The trials that need no further attempt."""
        return {one.trial for one in self.attempts if one.counts}

    @property
    def next_trial(self) -> PlannedTrial | None:
        """The first trial of the plan that is not done; None: all are."""
        done = self.done
        return next((trial for trial in self._plan.trials if trial.number not in done), None)

    def break_due(self, every: int) -> bool:
        """Whether a break comes before the next trial."""
        following = self.next_trial
        if following is None or following.number == 1:
            return False
        before = following.number - 1
        again = any(one.trial == following.number for one in self.attempts)
        return before % every == 0 and before not in self.breaks_after and not again
