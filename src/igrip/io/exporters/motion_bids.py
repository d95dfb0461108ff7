"""Motion-BIDS: the Brain Imaging Data Structure for motion capture.

Rules are those of bids-specification.readthedocs.io, "Motion"; the official validator judges what
is written (tests/io/exporters/test_motion_bids.py). Each camera is a tracking system, each trial a
run. What could name a person (dates, consent, comments) is left out.
"""

from __future__ import annotations

import csv
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError, RecordingError
from igrip.io.column_names import shortened
from igrip.io.datasets.dataset import Dataset, Trial
from igrip.io.datasets.trial import read_rows
from igrip.io.exporters import EXPORTERS
from igrip.io.exporters._tracks import Tracks, track_entities
from igrip.version import __version__

VERSION = "1.10.0"  # of the specification
TASK = "reach"
MISSING = "n/a"
COMPONENTS = {"qx": "quat_x", "qy": "quat_y", "qz": "quat_z", "qw": "quat_w"}
PEOPLE = ("age", "sex", "handedness", "group")  # columns of participants that may be published
TRIALS = ("hand", "target", "grip", "movement", "performed", "attempt")  # and of trials
FRAME = (
    "Right-handed, fixed to the table: the third axis (z) points up where gravity is known. "
    "Objects have the frame of their mesh; hands have the palm centre as their point."
)


@EXPORTERS.register("motion_bids")
def export_motion_bids(
    dataset: Dataset, folder: Path, on_recording: Callable[[], object]
) -> list[str]:
    """Write description, participants, and a folder with the runs of each participant."""
    labels = _labels(trial.participant or "unknown" for trial in dataset.trials)
    _describe(dataset, folder, labels)
    runs: Counter[tuple[str, str]] = Counter()
    scans: dict[str, list[Sequence[object]]] = {}
    problems: list[str] = []
    for trial in dataset.trials:
        subject = labels[trial.participant or "unknown"]
        camera = _label(trial.camera or "camera")
        runs[subject, camera] += 1
        name = f"sub-{subject}_task-{TASK}_tracksys-{camera}_run-{runs[subject, camera]:03d}"
        place = folder / f"sub-{subject}" / "motion"
        try:
            tracks = track_entities(dataset.observations(trial))
            if len(tracks.times) < 2 or not tracks.tracks:
                raise RecordingError("holds no movement")
        except RecordingError as error:
            problems.append(f"{trial.recording}: {error}")
        else:
            place.mkdir(parents=True, exist_ok=True)
            _write_run(place, name, camera, tracks, trial)
            row = [f"motion/{name}_motion.tsv", _known(trial.trial), *_levels(trial)]
            scans.setdefault(subject, []).append(row)
        on_recording()
    for subject, rows in scans.items():
        path = folder / f"sub-{subject}" / f"sub-{subject}_scans.tsv"
        _table(path, ["filename", "trial", *TRIALS], rows)
    return problems


def _write_run(place: Path, name: str, camera: str, tracks: Tracks, trial: Trial) -> None:
    """Write the files of one recording."""
    times = tracks.times - tracks.times[0]
    channels = list(_channels(tracks))
    values = [times, *(column for track in tracks.tracks for _, column in track.columns())]
    with (place / f"{name}_motion.tsv").open("w", encoding="utf-8", newline="") as file:
        for row in zip(*values, strict=True):
            file.write("\t".join(MISSING if x != x else f"{x:.9g}" for x in row) + "\n")
    _table(
        place / f"{name}_channels.tsv",
        ["name", "component", "type", "tracked_point", "units", "reference_frame"], channels,
    )  # fmt: skip
    frame = {"RotationRule": "right-hand", "RotationOrder": MISSING, "SpatialAxes": MISSING}
    levels = {"table": {**frame, "Description": FRAME}}
    _json(place / f"{name}_channels.json", {"reference_frame": {"Levels": levels}})
    kinds = Counter(channel[2] for channel in channels)
    effective = (len(times) - 1) / float(times[-1]) if times[-1] > 0 else 0.0
    _json(place / f"{name}_motion.json", {
        "TaskName": TASK, "TaskDescription": "Reach for an object and grasp it, or only approach.",
        "SamplingFrequency": round(1.0 / float(np.median(np.diff(times))), 3),
        "SamplingFrequencyEffective": round(effective, 3),
        "TrackingSystemName": camera, "Manufacturer": MISSING,
        "TrackedPointsCount": len(tracks.tracks), "MotionChannelCount": len(channels),
        "POSChannelCount": kinds["POS"], "ORNTChannelCount": kinds["ORNT"],
        "LATENCYChannelCount": kinds["LATENCY"], "ACCELChannelCount": 0, "GYROChannelCount": 0,
        "MAGNChannelCount": 0, "MissingValues": MISSING,
        "RecordingDuration": round(float(times[-1]), 6), "RecordingType": "continuous",
        "SoftwareVersions": f"igrip {__version__}",
    })  # fmt: skip
    _write_events(place / f"{name}_events.tsv", tracks, trial)


def _channels(tracks: Tracks) -> Iterator[Sequence[str]]:
    yield "latency", MISSING, "LATENCY", MISSING, "s", MISSING
    for track in tracks.tracks:
        for component, _ in track.columns():
            turns = component in COMPONENTS
            yield (
                f"{track.name}_{component}", COMPONENTS.get(component, component),
                "ORNT" if turns else "POS", track.name, MISSING if turns else "m", "table",
            )  # fmt: skip


def _write_events(path: Path, tracks: Tracks, trial: Trial) -> None:
    """Write the instruction, and the movement where its onset and end are known."""
    start, end = float(tracks.times[0]), float(tracks.times[-1])
    rows = [[0, round(end - start, 6), "trial", *_levels(trial)]]
    if trial.onset_s is not None and trial.end_s is not None:
        moved = [round(trial.onset_s - start, 6), round(trial.end_s - trial.onset_s, 6)]
        rows.append([*moved, "movement", *_levels(trial)])
    _table(path, ["onset", "duration", "trial_type", *TRIALS], rows)
    levels = {
        "trial": "the whole recording; the instruction was on the screen",
        "movement": "from the onset of the hand's movement to its end",
    }
    meanings = {"trial_type": {"Description": "What the row is about.", "Levels": levels}}
    meanings |= {name: {"Description": text} for name, text in _MEANINGS.items()}
    _json(path.with_suffix(".json"), meanings)


_MEANINGS: dict[str, Any] = {
    "hand": "Hand that was to move.",
    "target": "Object that was to be reached for: tracked point object_NAME; none: no reach.",
    "grip": "Grip that was to be used.",
    "movement": "Whether the object was to be grasped, or only approached.",
    "performed": "Whether the participant did as told.",
    "attempt": "Number of the attempt at this trial.",
}


def _levels(trial: Trial) -> list[str]:
    known = {name: getattr(trial, name, None) for name in TRIALS}
    return [_known(known[name] or trial.extra.get(name)) for name in TRIALS]


def _describe(dataset: Dataset, folder: Path, labels: Mapping[str, str]) -> None:
    description = {
        "Name": dataset.name, "BIDSVersion": VERSION, "DatasetType": "raw",
        "License": str(dataset.description.get("license", "not decided")),
        "GeneratedBy": [{"Name": "igrip export", "Version": __version__}],
    }  # fmt: skip
    _json(folder / "dataset_description.json", description)
    (folder / "README.md").write_text(
        f"# {dataset.name}\n\nReaching movements towards objects on a table, written by igrip "
        f"{__version__}. Tracked points are palms (`hand_…`) and the origins of objects' meshes "
        f"(`object_…`). {FRAME} Meshes: {', '.join(map(str, dataset.objects))}.\n",
        encoding="utf-8",
    )
    known = _people(dataset)
    used = [name for name in PEOPLE if any(name in row for row in known.values())]
    rows = [
        [f"sub-{label}", *(_known(known.get(name, {}).get(column)) for column in used)]
        for name, label in labels.items()
    ]
    _table(folder / "participants.tsv", ["participant_id", *used], rows)
    meanings = {name: {"Description": f"The participant's {name}."} for name in used}
    _json(
        folder / "participants.json", meanings or {"participant_id": {"Description": "Pseudonym"}}
    )
    scans = {"trial": {"Description": "Trial of the participant; each camera recorded it."}}
    scans |= {name: {"Description": text} for name, text in _MEANINGS.items()}
    _json(folder / "scans.json", scans)


def _people(dataset: Dataset) -> dict[str, dict[str, str]]:
    """Return what may be published about each participant."""
    try:
        header, rows = read_rows(dataset.path / "participants.tsv")
    except DatasetError:
        return {}  # the table is optional
    people = {}
    for _, cells in rows:
        row = dict(zip([name.lower() for name in header], cells, strict=False))
        name = row.get("participant") or row.get("participant_id") or ""
        people[name] = {key: row[key] for key in PEOPLE if row.get(key)}
    return people


def _labels(names: Iterable[str]) -> dict[str, str]:
    """Return a label of letters and digits for each participant.

    Raises
    ------
    DatasetError
        If two participants would have the same one.
    """
    labels: dict[str, str] = {}
    for name in names:
        labels.setdefault(name, _label(name.removeprefix("sub-")))
    twice = [name for name, label in labels.items() if list(labels.values()).count(label) > 1]
    if twice:
        raise DatasetError(
            f"participants {shortened(twice, 4)} have the same letters and digits, which is all "
            "that BIDS keeps: rename one in trials.tsv"
        )
    return labels


def _label(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "", name) or "unknown"


def _known(text: object) -> str:
    return MISSING if text in (None, "") else " ".join(str(text).split())


def _json(path: Path, content: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def _table(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
