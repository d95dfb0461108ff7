"""A participant's recordings after the session: onset and end found, and corrected by a person."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from igrip.errors import RecordingError
from igrip.experiment.corrections import Bounds, Corrections
from igrip.experiment.folder import StudyFolder
from igrip.experiment.journal import Journal
from igrip.experiment.study import StudyError
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.mcap.reader import McapReader
from igrip.lab.evaluation.movement import movement_bounds, smooth_speeds
from igrip.lab.evaluation.recorded_trial import RecordedTrial
from igrip.lab.evaluation.runner import describe_damage
from igrip.lab.evaluation.trial_description import describe_trial, find_problem


@dataclass(frozen=True)
class ReviewedRecording:
    """One recording.

    Attributes
    ----------
    recorded : RecordedTrial
        Its row of the table, and the detections.
    automatic : (float, float) or None
        Onset and end as the trace has them [s]; None: it has none.
    speeds : sequence of (float, float)
        Time [s] and speed [m/s] of the filtered trace.
    objects : mapping of str to (x, y, z)
        Where each object was first seen [m].
    damage : str or None
        What was wrong with the file.
    """

    recorded: RecordedTrial
    automatic: Bounds | None
    speeds: tuple[tuple[float, float], ...]
    objects: Mapping[str, tuple[float, float, float]]
    damage: str | None

    @property
    def trial(self) -> Trial:
        """Its row of the table."""
        return self.recorded.trial

    def nearest(self, t: float) -> str | None:
        """Return the object whose origin is nearest to the hand at a time [s]."""
        times = np.array(self.recorded.hand_times)
        if not len(times) or not self.objects:
            return None
        hand = self.recorded.hand_positions[int(np.argmin(np.abs(times - t)))]
        return min(self.objects, key=lambda id: math.dist(hand, self.objects[id]))


def read_recording(dataset: Dataset, trial: Trial) -> ReviewedRecording:
    """Read a recording and find onset and end of its movement."""
    recorded = RecordedTrial(trial)
    objects: dict[str, tuple[float, float, float]] = {}
    try:
        reader = dataset.observations(trial)
        for observation in reader:
            recorded.add(observation)
            for id, pose in observation.objects.items():
                if pose is not None:
                    objects.setdefault(id, pose.position)
        damage = describe_damage(reader)
    except RecordingError as error:
        damage = str(error)
    times, speeds = smooth_speeds(
        np.array(recorded.hand_times), np.array(recorded.hand_positions).reshape(-1, 3)
    )
    trace = tuple(zip(times.tolist(), speeds.tolist(), strict=True))
    return ReviewedRecording(
        recorded, movement_bounds(times, speeds, noisy=True), trace, objects, damage
    )


class Review:
    """The recordings of one participant, and what is corrected in them.

    Parameters
    ----------
    folder : StudyFolder
        Of the study, locked by the caller.
    participant : str
        Who has taken part.

    Attributes
    ----------
    dataset : Dataset
        The study's folder, as it was when the review began.

    Raises
    ------
    StudyError
        If they have not, or nothing was recorded yet.
    """

    def __init__(self, folder: StudyFolder, participant: str) -> None:
        if participant not in folder.participants():
            there = ", ".join(folder.participants()) or "nobody"
            raise StudyError(f"{participant}: has not taken part; there are: {there}")
        self._folder, self.participant = folder, participant
        folder.write_table()  # a crash may have left it behind the journal
        self.dataset = _open(folder)
        self._trials = [t for t in self.dataset.trials if t.participant == participant]
        if not self._trials:
            raise StudyError(f"{participant}: nothing was recorded yet")
        self._journal = Journal(folder.review(participant))
        self._corrections = Corrections(self._journal.events)
        self._read: dict[str, ReviewedRecording] = {}

    def __len__(self) -> int:
        return len(self._trials)

    def read(self, on_recording: Callable[[], object] = lambda: None) -> None:
        """Read all recordings."""
        for trial in self._trials:
            self._read[trial.recording] = read_recording(self.dataset, trial)
            on_recording()

    def __iter__(self) -> Iterator[ReviewedRecording]:
        return iter(self._read.values())

    def __getitem__(self, recording: str) -> ReviewedRecording:
        """Return a recording by its name.

        Raises
        ------
        StudyError
            If the participant has none of that name.
        """
        if recording not in self._read:
            raise StudyError(f"{recording!r:.60}: is no recording of {self.participant}")
        return self._read[recording]

    def summary(self, recording: str) -> dict[str, Any]:
        """Return the row of a recording in the list."""
        one = self[recording]
        trial = one.trial
        corrected = self._corrections.bounds(recording)
        bounds = corrected or one.automatic
        judged = self._corrections.performed(int(trial.trial or 0), _attempt(trial))
        performed = trial.performed == "yes" if judged is None else judged
        row = replace(trial, performed="yes" if performed else "no")
        problem = find_problem(replace(one.recorded, trial=row), bounds)
        description = describe_trial(one.recorded, bounds, ())
        reason = problem or description.get("invalid_reason") or one.damage
        return {
            "recording": recording, "trial": int(trial.trial or 0), "attempt": _attempt(trial),
            "camera": trial.camera, "hand": trial.hand, "target": trial.target,
            "grip": trial.grip, "movement": trial.movement, "levels": self._levels(trial),
            "performed": performed,
            "judged": judged is not None, "bounds": bounds, "corrected": corrected is not None,
            "valid": problem is None and bool(description.get("valid")), "reason": reason,
            "nearest": one.nearest(bounds[1]) if bounds else None,
            "repeated": self._is_repeated(trial), "comment": trial.extra.get("comment", ""),
        }  # fmt: skip

    def _levels(self, trial: Trial) -> dict[str, str]:
        known = {factor: getattr(trial, factor, None) for factor in self._folder.study.factors}
        return {
            factor: str(level or trial.extra.get(factor, "")) for factor, level in known.items()
        }

    def _is_repeated(self, trial: Trial) -> bool:
        """Return whether a later attempt replaces this one."""
        later = [_attempt(other) for other in self._trials if other.trial == trial.trial]
        return _attempt(trial) < max(later)

    def correct(self, recording: str, onset: float, end: float) -> None:
        """Set onset and end of a movement [s].

        Raises
        ------
        StudyError
            If they are no times within the recording, in that order.
        OSError
            If the disk is full; nothing has then changed.
        """
        times = self[recording].recorded.times
        if not times or not times[0] <= onset < end <= times[-1]:
            within = f"{times[0]:.3f} to {times[-1]:.3f} s" if times else "an empty recording"
            raise StudyError(
                f"onset {onset:.3f} s and end {end:.3f} s: must lie within {within}, in that order"
            )
        automatic = self[recording].automatic
        self._add(
            "bounds_corrected", recording=recording, onset_s=round(onset, 6), end_s=round(end, 6),
            automatic=automatic,
        )  # fmt: skip

    def withdraw(self, recording: str) -> None:
        """Let onset and end be those of the trace again."""
        if self._corrections.bounds(self[recording].trial.recording) is not None:
            self._add("bounds_withdrawn", recording=recording)

    def judge(self, recording: str, performed: bool) -> None:
        """State whether the participant did as told; it holds for all cameras of the attempt."""
        trial = self[recording].trial
        self._add(
            "judged", recording=recording, trial=int(trial.trial or 0), attempt=_attempt(trial),
            performed=performed,
        )  # fmt: skip

    def pictures(self, recording: str) -> list[tuple[float, bytes]]:
        """Return time [s] and picture, as it is stored, of each frame of a recording."""
        path = self.dataset.recording(self[recording].trial)
        return list(McapReader(path).pictures()) if path.suffix == ".mcap" else []

    def close(self) -> None:
        """Close the file of corrections."""
        self._journal.close()

    def _add(self, event: str, **fields: Any) -> None:
        self._journal.add(event, **fields)
        self._corrections.add(self._journal.events[-1])
        self._folder.write_table()


def _attempt(trial: Trial) -> int:
    return int(trial.extra.get("attempt", 1))


def _open(folder: StudyFolder) -> Dataset:
    try:
        return Dataset.open(folder.path)
    except Exception as error:
        if not any(folder.recordings.glob("*")):
            raise StudyError(f"{folder.path}: nothing was recorded yet") from error
        raise
