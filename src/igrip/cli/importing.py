"""``igrip import``: motion-capture files into a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import (
    NOT_KEPT,
    errors,
    interruptible,
    output,
    print_json,
    progress,
    warn,
)
from igrip.cli.inspection import print_inspection
from igrip.cli.outputs import file_option, folder_option
from igrip.errors import DatasetError
from igrip.io.column_map import read_column_map
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import Importer, ImportFiles, ReachReader, find_importer
from igrip.io.importers.motion_capture import MotionCapture
from igrip.io.inspection import inspect_files, map_from
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.resampling import ImportOptions
from igrip.io.tables import Table
from igrip.io.takes.declared import Declared
from igrip.io.text import TextError, read_text
from igrip.lab.evaluation.runner import spread
from igrip.objects.catalog import Catalog, load_objects

Unit = Annotated[
    str | None, typer.Option("--unit", help="Of lengths in the files: m, dm, cm, mm or in.")
]
TimeUnit = Annotated[
    str | None, typer.Option("--time-unit", help="Of times in the files: s, ms, us or ns.")
]
Up = Annotated[str | None, typer.Option("--up", help="The files' axis that points up: z, y, -z, …")]
Axes = Annotated[
    str | None,
    typer.Option("--axes", help="Our x, y, z in the files' axes, in place of --up: x,-z,y."),
]
Handedness = Annotated[
    str | None, typer.Option("--handedness", help="Of the files' axes: right or left.")
]
Quaternions = Annotated[
    str | None, typer.Option("--quaternions", help="Order of quaternions: xyzw or wxyz.")
]
InputRate = Annotated[
    float | None,
    typer.Option("--input-rate", help="Frames per second of files without times.", min=0.1),
]
Missing = Annotated[
    list[str] | None,
    typer.Option("--missing", help="A word or number that stands for a lost marker; repeatable."),
]


def import_tables(
    tables: Annotated[
        list[Path],
        typer.Argument(help="Files (.csv .tsv .txt .trc .parquet, also .gz; .c3d), or folders."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="New folder for the dataset.",
                     callback=folder_option(new=True)),
    ] = None,
    columns: Annotated[
        Path | None,
        typer.Option(help="A map of columns (.toml), for tables with a layout of your own."),
    ] = None,
    inspect: Annotated[
        bool, typer.Option("--inspect", help="Show what is understood, and write no dataset.")
    ] = False,
    write_map: Annotated[
        Path | None,
        typer.Option("--write-map", help="Write a map of columns to start from here.",
                     callback=file_option()),
    ] = None,
    unit: Unit = None,
    time_unit: TimeUnit = None,
    up: Up = None,
    axes: Axes = None,
    handedness: Handedness = None,
    quaternions: Quaternions = None,
    input_rate: InputRate = None,
    missing: Missing = None,
    mesh: Annotated[
        str,
        typer.Option(help="Model of objects that name none, and whose own name is no model's."),
    ] = "006_mustard_bottle",
    objects: options.Objects = None,
    rate: Annotated[
        float, typer.Option(help="Samples per second of the dataset.", min=1.0, max=1000.0)
    ] = 30.0,
    rest: Annotated[
        float, typer.Option(help="Rest added before onset [s].", min=0.0, max=60.0)
    ] = 0.0,
    noise: Annotated[
        float, typer.Option(help="Sd of sensor noise added per axis [m].", min=0.0, max=1.0)
    ] = 0.0,
    seed: options.Seed = 0,
    limit: options.Limit = 0,
    participants: Annotated[
        Path | None, typer.Option(help="Only these participants: a file with one id per line.")
    ] = None,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Turn motion-capture tables into a dataset.

    Exports of Motive, QTM, Vicon, TRC, C3D and Motion-BIDS are recognised by what they hold; for
    any other table, --columns names a map: see docs/importing.md. --inspect shows first what is
    understood, and --write-map writes a map to start from. Reaches that cannot be used are listed
    and left out. The dataset.json declares what was converted and added.

    Example: igrip import wispinski2021/ --out near-far --rest 1 --noise 0.004
    """
    declared = Declared(
        up=up, axes=axes, handedness=handedness, quaternions=quaternions, length_unit=unit,
        time_unit=time_unit, rate=input_rate, missing=tuple(missing or ()),
    )  # fmt: skip
    declared.frame()
    if inspect or write_map is not None:
        _inspect(tables, declared, write_map, as_json)
        return
    if out is None:
        raise DatasetError("name a new folder for the dataset with --out, or use --inspect")
    named = list(dict.fromkeys([*(objects or ["ycb"]), *([mesh] if ":" in mesh else [])]))
    catalog = load_objects(*named)
    changes = ImportOptions(mesh=mesh, rate=rate, rest=rest, noise=noise, seed=seed)
    if mesh != ImportOptions().mesh:  # the default is only needed by objects without a model
        catalog[mesh]
    files = ImportFiles(tables)
    importer = _importer(files, columns, declared, catalog)
    reaches = importer.reaches(files)
    if participants is not None:
        reaches = _only(reaches, participants)
    reaches = spread(reaches, limit)
    lenient = isinstance(importer, ColumnMapImporter | MotionCapture)
    problems: list[str] | None = [] if lenient else None
    begun = interruptible(NOT_KEPT)
    with begun, progress(f"importing {importer.name}", len(reaches)) as update:
        dataset = import_dataset(
            importer, reaches, out, catalog, changes, _absolute(named), problems,
            on_progress=lambda: update(advance=1),
        )  # fmt: skip
    summary = {
        "dataset": str(out),
        "name": dataset.name,
        "trials": len(dataset.trials),
        "participants": len({trial.participant for trial in dataset.trials}),
        "derived": dataset.description["derived"],
        "left_out": problems or [],
    }
    for text in _understood(files):
        errors.print(text, soft_wrap=True)
    for name, remarks in dataset.description["derived"].get("remarks", {}).items():
        for remark in remarks:
            warn(f"{name}: {remark}")
    for problem in problems or []:
        warn(f"left out: {problem}")
    if as_json:
        print_json(summary)
        return
    output.print(f"{summary['trials']} trials of {summary['participants']} participants in {out}")
    unknown = sum(trial.target is None for trial in dataset.trials)
    if unknown:
        warn(
            f"of {unknown} of {len(dataset.trials)} trials the target is not known, so they cannot "
            "be scored: name it in trials.tsv, or in a map (igrip import --inspect … --write-map "
            "map.toml)"
        )
    if unknown == len(dataset.trials):
        errors.print(f"Next: igrip view {out}", soft_wrap=True)
    else:
        errors.print(f"Next: igrip replay {out} --targets paper --targets repaired", soft_wrap=True)


def _understood(files: ImportFiles) -> list[str]:
    """Return what the files were taken for, a line for each kind."""
    kinds: dict[str, list[str]] = {}
    for source in files.opened.values():
        if isinstance(source, Table) and source.dialect != "Parquet":
            kinds.setdefault(f"{source.layout.name}: {source.dialect}", []).append(source.path.name)
    lines = []
    for kind, names in kinds.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        lines.append(f"{', '.join(names[:3])}{more} read as {kind}")
    return lines


def _importer(
    files: ImportFiles, columns: Path | None, declared: Declared, catalog: Catalog
) -> Importer:
    if columns is not None:
        return ColumnMapImporter(read_column_map(columns), declared)
    importer = find_importer(files)
    if isinstance(importer, MotionCapture):
        return MotionCapture(declared, catalog)
    return importer


def _inspect(
    paths: Sequence[Path], declared: Declared, write_map: Path | None, as_json: bool
) -> None:
    found = inspect_files(paths, declared)
    if as_json:
        print_json([one.to_dict() for one in found])
    else:
        for one in found:
            print_inspection(output, one)
    if write_map is not None:
        text = map_from(found, declared.rate)
        if write_map.exists():
            raise DatasetError(f"{write_map}: exists already; name a new file")
        try:
            write_map.write_text(text, encoding="utf-8")
        except OSError as error:
            raise DatasetError(f"{write_map}: {error.strerror or error}") from error
        errors.print(
            f"Next: adapt {write_map}, then igrip import … --columns {write_map} --out DATASET",
            soft_wrap=True,
        )
    if all(one.take is None for one in found):
        raise DatasetError("no body that moves was understood")


def _only(reaches: Sequence[ReachReader], file: Path) -> list[ReachReader]:
    """Return the reaches of the participants named in a file."""
    try:
        people = set(read_text(file).split())
    except (OSError, TextError) as error:
        raise DatasetError(f"{file}: cannot be read as a list of people: {error}") from error
    kept = [read for read in reaches if _participant(read) in people]
    if not kept:
        raise DatasetError(f"{file}: none of these people is in the tables")
    return kept


def _participant(read: ReachReader) -> str | None:
    try:
        return read().participant
    except DatasetError:  # it will be listed as left out
        return None


def _absolute(sources: Sequence[str]) -> list[str]:
    """Return the sources with absolute folders, so that the dataset finds them from anywhere."""
    return [str(Path(s).resolve()) if Path(s).is_dir() else s for s in sources]
