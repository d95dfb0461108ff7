"""What is wrong with the trials of a dataset, found by reading each recording whole."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np

from igrip.errors import IgripError
from igrip.io.column_names import near_miss
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.hand_ids import match_hand
from igrip.io.plausibility import Samples, check_samples
from igrip.observation import Observation

NO_REACH = "none"
GRIPS = ("palmar", "pinch")
SIDES = ("left", "right")
SLACK = 0.1  # s that a recording may end before its movement does


class Flaw(NamedTuple):
    """One defect of a trial.

    Attributes
    ----------
    verdict : str
        ``error``: the trial cannot be scored; ``remark``: it can, but something is odd.
    text : str
        For the user.
    """

    verdict: Literal["error", "remark"]
    text: str


@dataclass
class _Track:
    """Measurements of one hand or object."""

    times: list[float] = field(default_factory=list)
    positions: list[tuple[float, float, float]] = field(default_factory=list)
    orientations: list[tuple[float, float, float, float]] = field(default_factory=list)

    def samples(self) -> Samples:
        turns = np.array(self.orientations) if self.orientations else None
        return Samples(np.array(self.times), np.array(self.positions).reshape(-1, 3), turns)


@dataclass
class _Content:
    """What a recording holds."""

    times: list[float] = field(default_factory=list)
    hands: dict[str, _Track] = field(default_factory=dict)
    objects: dict[str, _Track] = field(default_factory=dict)
    models: dict[str, str] = field(default_factory=dict)

    def add(self, observation: Observation) -> None:
        self.times.append(observation.t)
        for id, hand in observation.hands.items():
            track = self.hands.setdefault(id, _Track())
            if hand is not None:
                track.times.append(observation.t if hand.t is None else hand.t)
                track.positions.append(hand.position)
        for id, pose in observation.objects.items():
            track = self.objects.setdefault(id, _Track())
            if pose is not None:
                track.times.append(observation.t if pose.t is None else pose.t)
                track.positions.append(pose.position)
                track.orientations.append(pose.orientation)
                if pose.model is not None:
                    self.models.setdefault(id, pose.model)


def check_trial(dataset: Dataset, trial: Trial, models: Collection[str]) -> list[Flaw]:
    """Return what is wrong with one trial; its recording is read whole.

    Parameters
    ----------
    dataset : Dataset
        Opened leniently.
    trial : Trial
        A row of its table.
    models : collection of str
        Names of the models that its catalogue has.
    """
    flaws = [Flaw("error", trial.problem)] if trial.problem else []
    content = _Content()
    try:
        source = dataset.observations(trial)
        for observation in source:
            content.add(observation)
    except IgripError as error:
        return [*flaws, Flaw("error", str(error))]
    flaws += [Flaw("remark", text) for text in _damage(source)]
    if not content.times:
        return [*flaws, Flaw("error", "the recording is empty")]
    flaws += _task_flaws(trial, content)
    flaws += [
        Flaw("error", f"object {id!r}: no model {model!r}{near_miss(model, models)}")
        for id, model in content.models.items()
        if model not in models
    ]
    flaws += [
        Flaw("error", f"object {id!r} has no model")
        for id, track in content.objects.items()
        if track.times and id not in content.models
    ]
    findings = check_samples(
        {id: track.samples() for id, track in content.hands.items()},
        {id: track.samples() for id, track in content.objects.items()},
        dataset.frame.length_unit,
        dataset.frame.time_unit,
    )
    flaws += [
        Flaw("error" if finding.verdict == "refuse" else "remark", finding.text)
        for finding in findings
    ]
    return flaws


def unused_recordings(dataset: Dataset) -> list[str]:
    """Return the recordings that no trial names."""
    used = set()
    for trial in dataset.trials:
        try:
            used.add(dataset.recording(trial))
        except IgripError:
            continue
    folder = dataset.path / "recordings"
    unused = [path for path in dataset.recordings() if path not in used]
    return [path.relative_to(folder).as_posix() for path in unused]


def _task_flaws(trial: Trial, content: _Content) -> list[Flaw]:
    flaws = []
    hands = [id for id, track in content.hands.items() if track.times]
    objects = [id for id, track in content.objects.items() if track.times]
    if trial.hand is None:
        if trial.target != NO_REACH:
            flaws.append(Flaw("error", f"its hand is not known; the recording has {_list(hands)}"))
    elif match_hand(trial.hand, hands) is None:
        text = f"hand {trial.hand!r} was never seen; the recording has {_list(hands)}"
        flaws.append(Flaw("error", text))
    elif trial.hand not in hands:
        match = match_hand(trial.hand, hands)
        flaws.append(Flaw("remark", f"hand {trial.hand!r} is {match!r} in the recording"))
    if trial.target is None:
        flaws.append(Flaw("error", f"its target is not known; there are {_list(objects)}"))
    elif trial.target != NO_REACH and trial.target not in objects:
        text = f"target {trial.target!r} never appears{near_miss(trial.target, objects)}"
        flaws.append(Flaw("error", f"{text}; there are {_list(objects)}"))
    if trial.grip is not None and trial.grip not in GRIPS:
        text = f"grip {trial.grip!r} is neither palmar nor pinch{near_miss(trial.grip, GRIPS)}"
        flaws.append(Flaw("remark", text))
    if trial.camera_side not in (None, *SIDES):
        flaws.append(Flaw("remark", f"camera_side {trial.camera_side!r} is neither left nor right"))
    begin, end = content.times[0], content.times[-1]
    for name in ("onset_s", "end_s"):
        time = getattr(trial, name)
        if time is not None and not begin - SLACK <= time <= end + SLACK:
            text = f"{name} {time:g} s is outside the recording, {begin:.4g} to {end:.4g} s"
            flaws.append(Flaw("error", text))
    if (trial.onset_s is None) != (trial.end_s is None):
        flaws.append(Flaw("remark", "its onset or its end is missing, so both will be estimated"))
    return flaws


def _damage(source: object) -> list[str]:
    """Return what was damaged in a recording that was read, and what is unusual."""
    cut, defects = getattr(source, "cut", None), getattr(source, "defects", None)
    remarks = [*([cut] if cut else []), *getattr(source, "remarks", [])]
    return remarks + (list(defects.lines()) if defects else [])


def _list(ids: Collection[str]) -> str:
    return ", ".join(map(repr, ids)) or "none"
