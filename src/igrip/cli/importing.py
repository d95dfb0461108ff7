"""``igrip import``: motion-capture files into a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import errors, output, print_json, progress, warn
from igrip.errors import DatasetError
from igrip.io.column_map import read_column_map
from igrip.io.mapped_import import ColumnMapImporter
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import Importer, ImportFiles, ReachReader, find_importer
from igrip.io.resampling import ImportOptions
from igrip.lab.evaluation.runner import spread
from igrip.objects.catalog import load_objects


def import_tables(
    tables: Annotated[
        list[Path], typer.Argument(help="Tables (.parquet, .csv, .tsv), or a folder of them.")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", help="New folder for the dataset.")],
    columns: Annotated[
        Path | None,
        typer.Option(help="A map of columns (.toml), for tables with a layout of your own."),
    ] = None,
    mesh: Annotated[
        str, typer.Option(help="Model put at each object's place.")
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
) -> None:
    """Turn motion-capture tables into a dataset.

    A known layout is recognised by its columns; for any other, --columns names a map: see
    docs/importing.md. Reaches that cannot be used are then listed and left out. The dataset.json
    declares what was added to the recorded movements (rest, noise, meshes).

    Example: igrip import wispinski2021/ --out near-far --rest 1 --noise 0.004
    """
    named = list(dict.fromkeys([*(objects or ["ycb"]), *([mesh] if ":" in mesh else [])]))
    catalog = load_objects(*named)
    changes = ImportOptions(mesh=mesh, rate=rate, rest=rest, noise=noise, seed=seed)
    catalog[mesh]
    files = ImportFiles(tables)
    importer: Importer = (
        find_importer(files) if columns is None else ColumnMapImporter(read_column_map(columns))
    )
    reaches = importer.reaches(files)
    if participants is not None:
        reaches = _only(reaches, participants)
    reaches = spread(reaches, limit)
    problems: list[str] | None = None if columns is None else []
    with progress(f"importing {importer.name}", len(reaches)) as update:
        dataset = import_dataset(
            importer, reaches, out, catalog, changes, _absolute(named), problems,
            on_progress=lambda: update(advance=1),
        )  # fmt: skip
    if not dataset.trials:
        raise DatasetError(f"nothing could be imported; first: {problems[0] if problems else '-'}")
    summary = {
        "dataset": str(out),
        "name": dataset.name,
        "trials": len(dataset.trials),
        "participants": len({trial.participant for trial in dataset.trials}),
        "derived": dataset.description["derived"],
        "left_out": problems or [],
    }
    for problem in problems or []:
        warn(f"left out: {problem}")
    if as_json:
        print_json(summary)
        return
    output.print(f"{summary['trials']} trials of {summary['participants']} participants in {out}")
    errors.print(f"Next: igrip replay {out} --targets paper --targets repaired")


def _only(reaches: Sequence[ReachReader], file: Path) -> list[ReachReader]:
    """Return the reaches of the participants named in a file."""
    try:
        people = set(file.read_text(encoding="utf-8").split())
    except (OSError, ValueError) as error:
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
