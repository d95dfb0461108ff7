"""What is understood of files before anything is written, and a map of columns to start from."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from igrip.errors import DatasetError
from igrip.io.column_names import trial_column
from igrip.io.importers import ImportFiles
from igrip.io.plausibility import Samples, check_samples
from igrip.io.takes.declared import Declared
from igrip.io.takes.files import read_take
from igrip.io.takes.roles import hands_of, objects_of
from igrip.io.takes.sections import merge_tracking_systems
from igrip.io.takes.take import Take
from igrip.io.takes.upright import with_upright_axes


@dataclass(frozen=True)
class Inspection:
    """What is understood of one file.

    Attributes
    ----------
    name : str
        Of the table or take.
    path : Path
        The file.
    layout, dialect : str
        What it was recognised as, and how it is written.
    columns : sequence of str
        Its columns.
    take : Take or None
        What moves in it.
    problem : str or None
        Why it holds no take.
    findings : sequence of str
        What is implausible or was repaired.
    """

    name: str
    path: Path
    layout: str
    dialect: str = ""
    columns: Sequence[str] = ()
    take: Take | None = None
    problem: str | None = None
    findings: Sequence[str] = field(default=())

    def to_dict(self) -> dict[str, Any]:
        """Return it as JSON."""
        found: dict[str, Any] = {
            "name": self.name, "path": str(self.path), "layout": self.layout,
            "dialect": self.dialect, "columns": list(self.columns), "problem": self.problem,
            "findings": list(self.findings),
        }  # fmt: skip
        take = self.take
        if take is not None:
            found |= {
                "seconds": take.seconds,
                "rate_hz": 1.0 / take.interval,
                "frame": take.frame.to_dict(),
                "hands": hands_of(take),
                "bodies": {key: body_summary(take, key) for key in take.tracks},
            }
        return found


def body_summary(take: Take, key: str) -> dict[str, Any]:
    """Return what is known of one body: its kind, samples, gaps, and where it was [m]."""
    track = take.tracks[key]
    summary: dict[str, Any] = {
        "kind": take.kinds[key], "turns": track.orientations is not None,
        "samples": len(track.times), "missing": take.gaps.get(key, 0),
    }  # fmt: skip
    if len(track.times):
        low, high = track.positions.min(axis=0), track.positions.max(axis=0)
        summary |= {"min_m": low.round(4).tolist(), "max_m": high.round(4).tolist()}
    return summary


def inspect_files(paths: Iterable[Path], declared: Declared) -> list[Inspection]:
    """Return what is understood of files; nothing is written.

    Raises
    ------
    DatasetError
        If a file does not exist, or there is none that could be read.
    """
    files = ImportFiles(paths)
    found = []
    for name, source in merge_tracking_systems(files.opened).items():
        if isinstance(source, DatasetError):
            path = files.paths[0] if len(files.paths) == 1 else Path(name)
            found.append(Inspection(name, path, "not readable", problem=str(source)))
            continue
        path = source if isinstance(source, Path) else source.path
        layout = "C3D" if isinstance(source, Path) else source.layout.name
        dialect = "" if isinstance(source, Path) else source.dialect
        columns = () if isinstance(source, Path) else source.columns
        try:
            take = read_take(name, source, declared)
        except DatasetError as error:
            found.append(Inspection(name, path, layout, dialect, columns, None, str(error)))
            continue
        findings = [
            *_several_trials(columns),
            *take.remarks,
            *(finding.text for finding in _findings(take)),
        ]
        found.append(Inspection(name, path, layout, dialect, columns, take, None, findings))
    if not found:
        inside = sorted({path.suffix or path.name for p in files.paths for path in _files(p)})
        raise DatasetError(
            f"{', '.join(map(str, files.paths))}: no table and no C3D file; found "
            f"{', '.join(inside[:10]) or 'nothing'}{_other_command(inside)}"
        )
    return found


def _other_command(endings: Iterable[str]) -> str:
    """Return which command reads files with these endings, as text; empty if none does."""
    known = {ending.lower() for ending in endings}
    if known & {".jsonl", ".mcap", ".db3"}:
        return ". Recordings are read by igrip replay and igrip view"
    if known & {".stl", ".obj", ".ply", ".glb", ".gltf", ".off", ".3mf", ".dae"}:
        return ". Meshes are read by igrip grips --objects FOLDER"
    return ""


def map_from(inspections: Sequence[Inspection], rate: float | None = None) -> str:
    """Return a map of columns to start from, as TOML.

    Parameters
    ----------
    inspections : sequence of Inspection
        What the files hold.
    rate : float or None
        The rate that was declared for files without times [Hz]; the map declares it too.

    Raises
    ------
    DatasetError
        If no file holds anything that moves.
    """
    moving = [found for found in inspections if found.take is not None]
    if not moving:
        columns = next((found.columns for found in inspections if found.columns), ())
        problems = "; ".join(found.problem for found in inspections if found.problem)
        raise DatasetError(
            f"nothing that moves was found ({problems}); columns: {', '.join(columns) or 'none'}"
        )
    first = moving[0]
    take = first.take
    assert take is not None
    lines = [
        f"# Made from {first.path.name}, {first.layout}.",
        "# Adapt it, then: igrip import FILES --columns THIS --out DATASET",
        'name = "Our lab"',
        f'unit = "{take.frame.length_unit}"  # of lengths: m, dm, cm, mm or in',
    ]
    if take.frame.time_unit != "s":
        lines.append(f'time_unit = "{take.frame.time_unit}"')
    if rate is not None:
        lines.append(f"rate = {rate:.6g}  # frames per second, for files without times")
    axes = json.dumps(list(take.frame.axes))
    lines += [
        f"axes = {axes}  # our x, y, z in the file's axes; z up is right as it is: x, y, z",
        "",
        "[samples]",
        f'table = "{_pattern([found.name for found in moving])}"',
    ]
    trial = trial_column(first.columns)
    if trial is not None:
        lines.append(f"trial = {json.dumps(trial, ensure_ascii=False)}")
    lines += _hand_lines(take)
    lines += [
        "[trials]  # without a table named trials, each take is a trial",
        '# table = "trials"  # columns: trial (name of the take), participant, hand, target',
        f'hand = "={next(iter(hands_of(take)), "right")}"',
        '# target = "=mug"  # the same in all takes, or a column of the table of trials',
        "",
    ]
    hands = set(_map_hands(take).values())
    for id, key in objects_of(take).items():
        if key in hands:
            continue
        turns = take.tracks[key].orientations is not None
        lines += [
            f"[objects.{_key(id)}]",
            f"body = {json.dumps(key, ensure_ascii=False)}",
            '# model = "025_mug"  # else the one with this name, else that of --mesh',
        ]
        lines += (
            ['# pivot = "mesh"  # if the body has the origin and axes of the mesh', ""]
            if turns
            else [""]
        )
    return "\n".join(lines)


def _several_trials(columns: Sequence[str]) -> list[str]:
    """Return the remark that a column separates trials, which are here shown as one take."""
    trial = trial_column(columns)
    if trial is None:
        return []
    return [f"the column {trial!r} separates trials; import does so"]


def _map_hands(take: Take) -> dict[str, str]:
    """Return the bodies of the hands, by id; the first body where none has the name of a hand."""
    return hands_of(take) or {"right": next(iter(take.tracks))}


def _hand_lines(take: Take) -> list[str]:
    if "" in take.tracks:
        return ["# t, x, y, z: the columns of those names", ""]
    hands = _map_hands(take)
    note = "" if hands_of(take) else "  # none has the name of a hand: choose"
    lines = [""]
    for id, key in hands.items():
        lines += [f"[hands.{id}]", f"body = {json.dumps(key, ensure_ascii=False)}{note}", ""]
    return lines


def _findings(take: Take) -> list[Any]:
    def samples(keys: Mapping[str, str]) -> dict[str, Samples]:
        return {
            id: Samples(track.times, track.positions, track.orientations)
            for id, key in keys.items()
            for track in [with_upright_axes(take.tracks[key], take.frame)]
        }

    hands = hands_of(take) or ({"hand": ""} if "" in take.tracks else {})
    objects = {id: key for id, key in objects_of(take).items() if key not in hands.values()}
    return check_samples(
        samples(hands), samples(objects), take.frame.length_unit, take.frame.time_unit
    )


def _pattern(names: Sequence[str]) -> str:
    """Return a pattern that all names match."""
    if len(names) == 1:
        return names[0]
    common = 0
    while len({name[: common + 1] for name in names}) == 1 and common < len(names[0]):
        common += 1
    return names[0][:common] + "*"


def _key(name: str) -> str:
    """Return a name as a key of TOML."""
    plain = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if plain else json.dumps(name, ensure_ascii=False)


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return [file for file in path.rglob("*") if file.is_file()]


def extent_of(take: Take) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]] | None:
    """Return the lowest and highest coordinates of all bodies [m]; None if nothing was seen."""
    points = [track.positions for track in take.tracks.values() if len(track.times)]
    if not points:
        return None
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)
