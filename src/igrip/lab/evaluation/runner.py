"""Estimators over the recordings of a dataset: the same ``update`` as live, in many processes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

from igrip.config import Config
from igrip.errors import IgripError, StorageError
from igrip.estimator import Estimator
from igrip.geometry.scene import PlacedObject
from igrip.intention import Intention
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.lab.evaluation.commitments import MessageEvidence
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.parallel import ALONE, Workers
from igrip.objects.catalog import Catalog
from igrip.observation import Observation

Result = TypeVar("Result")
T = TypeVar("T")


class EstimatorRun:
    """An estimator at work, and all its predictions."""

    def __init__(self, catalog: Catalog, config: Config) -> None:
        self.config = config
        self.estimator = Estimator(catalog, config)
        self.intentions: list[Intention] = []  # all, in order
        self.speeds: list[float] = []  # of the hand of each [m/s]; NaN: not known
        self.evidence: list[MessageEvidence] = []  # after each message

    def update(self, observation: Observation) -> list[Intention]:
        """Process one message; return the new intentions."""
        estimator = self.estimator
        intentions = estimator.update(observation)
        hands = estimator.hands
        self.intentions += intentions
        for intention in intentions:
            motion = hands[intention.hand].motion
            answered = intention.status in ("idle", "reaching", "holding")
            self.speeds.append(motion.speed if answered and motion else math.nan)
        # which objects are trusted changes with the next message, so it is written down now
        evidence = {
            hand: e._replace(
                trusted_objects=frozenset(id for id in e.distances if id in e.trusted_objects)
            )
            for hand, e in estimator.evidence.items()
        }
        self.evidence.append(MessageEvidence(evidence, frozenset(estimator.rejected_hands)))
        return intentions


@dataclass
class TrialRun:
    """What a recording holds, and what estimators predicted for it."""

    recorded: RecordedTrial  # the trial, and the detections of its hand and target
    estimators: Sequence[EstimatorRun]  # one per configuration
    objects: list[PlacedObject] = field(default_factory=list)  # at the onset, or else at the end
    unknown_objects: list[str] = field(default_factory=list)  # without a model, with the reason
    cut: str | None = None  # where the recording was cut off, and what was damaged in it
    problem: str | None = None  # why there is nothing to score

    @property
    def trial(self) -> Trial:
        """Its row of the table."""
        return self.recorded.trial


def run_trial(
    dataset: Dataset, trial: Trial, catalog: Catalog, configs: Sequence[Config]
) -> TrialRun:
    """Run estimators over one recording, which is read once."""
    run = TrialRun(RecordedTrial(trial), [EstimatorRun(catalog, config) for config in configs])
    if trial.problem:
        run.problem = trial.problem
        return run
    first = run.estimators[0].estimator
    try:
        trial = dataset.with_hand(trial)
        run.recorded.trial = trial
        reader = dataset.observations(trial)
        for observation in reader:
            if not run.recorded.times:
                run.recorded.trial = trial = shift_trial(trial, getattr(reader, "shift", 0.0))
            run.recorded.add(observation)
            for estimator in run.estimators:
                estimator.update(observation)
            objects = first.objects
            run.recorded.place_target(observation.t, objects)
            if trial.onset_s is None or observation.t <= trial.onset_s or not run.objects:
                run.objects = objects
        run.cut = describe_damage(reader)
    except StorageError:
        raise  # another time it may be there
    except IgripError as error:
        run.problem = str(error)
    except Exception as error:  # one odd recording must not end the evaluation of all others
        run.problem = f"cannot be evaluated: {error!r:.200}"
    inputs = first.inputs()["objects"]
    run.unknown_objects = sorted(
        f"{id}: {state['reason']}" for id, state in inputs.items() if not state["known"]
    )
    return run


def shift_trial(trial: Trial, shift: float) -> Trial:
    """Return a trial on the clock of its recording, which adds ``shift`` [s] to all times."""
    if not shift:
        return trial
    onset, end = (None if t is None else t + shift for t in (trial.onset_s, trial.end_s))
    return replace(trial, onset_s=onset, end_s=end)


def describe_damage(reader: object) -> str | None:
    """Return what was damaged in a recording that was read, and what is unusual; None: nothing."""
    cut, remarks = getattr(reader, "cut", None), getattr(reader, "remarks", [])
    defects = getattr(reader, "defects", None)
    lines = [*([cut] if cut else []), *remarks, *(defects.lines() if defects else [])]
    return "; ".join(lines) or None


def run_trials(
    dataset: Dataset,
    catalog: Catalog,
    configs: Sequence[Config],
    analyse: Callable[[TrialRun], Result],
    trials: Sequence[Trial],
    workers: Workers = ALONE,
) -> Iterator[Result]:
    """Run estimators over trials of a dataset, by workers; yield in order.

    ``analyse`` reduces a :class:`TrialRun` to what is wanted of it; another process finds it by its
    name.
    """
    run = partial(run_trial, dataset, catalog=catalog, configs=tuple(configs))
    return workers.map(partial(_run_and_analyse, run, analyse), trials)


def _run_and_analyse(
    run: Callable[[Trial], TrialRun], analyse: Callable[[TrialRun], Result], trial: Trial
) -> Result:
    return analyse(run(trial))


def spread(trials: Sequence[T], limit: int) -> list[T]:
    """Return ``limit`` trials evenly spread over the table; 0: all."""
    count = min(limit or len(trials), len(trials))
    return [trials[k * len(trials) // count] for k in range(count)]
