"""Trials replayed to what commitments are decided on: once for each setting of what is before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from igrip.config import Config
from igrip.errors import DatasetError, did_you_mean
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.evaluation.commitments import MessageEvidence
from igrip.lab.evaluation.runner import TrialRun, run_trials, spread
from igrip.lab.evaluation.trial_description import NO_REACH, find_problem
from igrip.lab.parallel import ALONE, Workers, count_jobs
from igrip.lab.tuning.outcomes import Outcomes, Replay, outcome
from igrip.lab.tuning.space import Values, with_values
from igrip.objects.catalog import Catalog

UNKNOWN = "unknown"  # the participant of trials without one


class Unusable(NamedTuple):
    """A trial that teaches nothing, and why."""

    recording: str
    problem: str


def choose_trials(dataset: Dataset, participants: Sequence[str], limit: int) -> list[Trial]:
    """Return the trials of some people, at most ``limit`` of each (0: all), evenly spread.

    Raises
    ------
    DatasetError
        If somebody is not in the dataset.
    """
    there = people_of(dataset)
    for name in participants:
        if name not in there:
            near = did_you_mean(name, there)
            raise DatasetError(f"{dataset.path}: no participant {name!r}{near}; there are: "
                               f"{', '.join(there)}")  # fmt: skip
    return [
        trial
        for name in dict.fromkeys(participants)
        for trial in spread([t for t in dataset.trials if _person(t) == name], limit)
    ]


def people_of(dataset: Dataset) -> list[str]:
    """Return the participants of a dataset's trials, sorted."""
    return sorted({_person(trial) for trial in dataset.trials})


def replayed(run: TrialRun) -> Replay | Unusable:
    """Return what a run holds for commitments; it has one estimator."""
    trial, recorded = run.trial, run.recorded
    reaches = trial.target != NO_REACH
    bounds = recorded.bounds() if reaches and run.problem is None else None
    problem = run.problem or find_problem(recorded, bounds)
    if problem is not None:
        return Unusable(trial.recording, problem)
    messages = run.estimators[0].evidence
    if bounds is not None:
        assert trial.hand is not None
        messages = [_of_hand(m, trial.hand) for m in messages if _begun(m) <= bounds[1]]
    return Replay(
        trial.recording, _person(trial), trial.hand, trial.target if reaches else None, bounds,
        recorded.seconds, tuple(messages),
    )  # fmt: skip


class Replays:
    """Trials of a dataset, and what configurations make of them.

    Parameters
    ----------
    dataset, catalog : Dataset, Catalog
        Where they are, and their objects.
    config : Config
        What is not tuned.
    trials : sequence of Trial
        Which.
    workers : Workers
        Of them as many as the trials keep busy.

    Attributes
    ----------
    usable : list of Replay
        As the configuration has it.
    unusable : list of Unusable
        The others.
    """

    def __init__(
        self, dataset: Dataset, catalog: Catalog, config: Config, trials: Sequence[Trial],
        workers: Workers = ALONE,
    ) -> None:  # fmt: skip
        self._dataset, self._catalog, self._config = dataset, catalog, config
        self._workers = workers
        results = self._replay(config, trials)
        self.usable = [one for one in results if isinstance(one, Replay)]
        self.unusable = [one for one in results if isinstance(one, Unusable)]
        kept = {one.recording for one in self.usable}
        self._trials = [trial for trial in trials if trial.recording in kept]
        self._known: dict[str, list[Replay]] = {config.motion.model_dump_json(): self.usable}

    def outcomes(self, values: Values) -> Outcomes:
        """Return what came of the usable trials with other numbers in the configuration."""
        commitment = with_values(self._config, values).commitment
        return Outcomes.of([outcome(replay, commitment) for replay in self.replayed(values)])

    def replayed(self, values: Values) -> list[Replay]:
        """Return the usable trials with other numbers before the commitment."""
        config = with_values(self._config, values)
        key = config.motion.model_dump_json()
        if key not in self._known:
            results = self._replay(config, self._trials)
            self._known[key] = [one for one in results if isinstance(one, Replay)]
        return self._known[key]

    def _replay(self, config: Config, trials: Sequence[Trial]) -> list[Replay | Unusable]:
        workers = replace(self._workers, jobs=count_jobs(self._workers.jobs, len(trials)))
        run = run_trials(self._dataset, self._catalog, [config], replayed, trials, workers)
        return list(run)


def _person(trial: Trial) -> str:
    return trial.participant or UNKNOWN


def _begun(message: MessageEvidence) -> float:
    """Return the time of a message; one in which no hand was accepted decides nothing."""
    return min((evidence.t for evidence in message.hands.values()), default=0.0)


def _of_hand(message: MessageEvidence, hand: str) -> MessageEvidence:
    hands = {hand: message.hands[hand]} if hand in message.hands else {}
    return MessageEvidence(hands, message.rejected & {hand})
