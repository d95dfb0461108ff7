"""``igrip benchmark``: any estimator over declared sets, in one table."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import (
    cluster_page,
    errors,
    inform,
    interruptible,
    output,
    print_json,
    progress,
    table_of,
)
from igrip.cli.outputs import folder_option
from igrip.errors import DatasetError, requires_extra
from igrip.io.datasets.shared import address_of
from igrip.io.import_dataset import import_dataset
from igrip.io.importers import IMPORTERS, ImportFiles
from igrip.io.resampling import ImportOptions
from igrip.lab.benchmark.answers import EntryError
from igrip.lab.benchmark.entries import Entry, parse_entry
from igrip.lab.benchmark.run import check_entries, run_entry
from igrip.lab.benchmark.sets import DECLARED, DESCRIPTION, open_set, parse_set
from igrip.lab.parallel import Workers, count_jobs
from igrip.objects.catalog import load_objects
from igrip.targets import TARGETS
from igrip.version import __version__


def benchmark(
    sets: Annotated[
        list[str],
        typer.Argument(
            help="NAME=FOLDER of each set: a dataset, or the files of a declared set "
            f"({', '.join(DECLARED)})."
        ),
    ],
    entry: Annotated[
        list[str] | None,
        typer.Option(
            help="A targets estimator of igrip, NAME=module:function or NAME=program:COMMAND; "
            "repeatable. Default: all of igrip's."
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="Folder for the table and what is done.",
                     callback=folder_option()),
    ] = Path("benchmark"),
    limit: options.Limit = 0,
    jobs: options.Jobs = 0,
    scheduler: options.Scheduler = None,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Judge estimators, igrip's own and others, over sets of reaches: one table.

    Of a declared set one person in five is judged, always the same people; entries may learn from
    the others. Of any other set everybody is judged. The table has earliness, accuracy,
    calibration, leases, false leases and cost, each with an interval; an entry that fails is left
    out of it. What is done is kept: the same command goes on. docs/benchmark.md tells how to enter.

    Example: igrip benchmark near_far=wispinski2021/ --entry bayes --entry mine=my_module:Estimator
    """
    entries = _entries(entry)
    named = dict(parse_set(text) for text in sets)
    if len(named) < len(sets):
        raise DatasetError("two sets have the same name; give NAME=FOLDER")
    with requires_extra("pandas", "benchmark", "the benchmark"):
        from igrip.lab.benchmark.table import frame_of, lines_of, markdown, sum_up
    out.mkdir(parents=True, exist_ok=True)
    rows, failed = [], {}
    kept = f"what is done is kept in {out}; the same command goes on from there"
    with interruptible(kept):
        opened = [open_set(n, _dataset_of(n, folder, out)) for n, folder in named.items()]
        for judged in (one.spread(limit) for one in opened):
            name = judged.name
            catalog = load_objects(*judged.dataset.objects)
            with errors.status(f"trying the entries on {name} …"):
                check_entries(entries, judged, catalog)
            inform(f"{name}: {len(judged.trials)} recordings, {judged.split}")
            workers = Workers(count_jobs(jobs, len(judged.trials)), scheduler, cluster_page)
            for one in (one for one in entries if one.name not in failed):
                try:
                    with progress(f"{name}: {one.name}", len(judged.trials)) as update:
                        for row in run_entry(one, judged, catalog, out, workers):
                            rows.append(row)
                            update(advance=1)
                except EntryError as error:
                    failed[one.name] = str(error)
                    inform(f"{one.name} is left out of the table: {error}")
    if len(failed) == len(entries):
        raise EntryError(next(iter(failed.values())))
    frame = frame_of([row for row in rows if row["entry"] not in failed])
    table = sum_up(frame)
    (out / "table.md").write_text(markdown(table), encoding="utf-8")
    frame.drop(columns=["row", "stamp"]).to_json(out / "trials.jsonl", orient="records", lines=True)
    if as_json:
        print_json(table)
    else:
        head, *lines = lines_of(table)
        output.print(table_of(head, lines, leading=2))
        output.print(f"{out / 'table.md'}", soft_wrap=True)
    if not any(row["reaches"] for row in table):
        raise DatasetError("no recording could be scored; next: igrip check FOLDER")
    if failed:
        raise EntryError(
            f"left out of the table: {', '.join(failed)}; {next(iter(failed.values()))}"
        )


def _entries(given: list[str] | None) -> list[Entry]:
    entries = [parse_entry(text) for text in given or TARGETS.names()]
    names = [one.name for one in entries]
    if len(set(names)) < len(names):
        raise EntryError("two entries have the same name; give NAME=…")
    return entries


def _dataset_of(name: str, folder: Path, out: Path) -> Path:
    """Return the folder of a dataset: the one that is given, or what its files are imported to."""
    if address_of(folder) is not None or (folder / DESCRIPTION).is_file():
        return folder
    imported = out / "sets" / f"{name}-{_files_digest(folder)}"
    if not imported.exists():
        importer = IMPORTERS.get(DECLARED[name].importer)
        files = ImportFiles([folder])
        if not importer.recognises(files):
            raise DatasetError(f"{folder}: has not the layout of {name} ({DECLARED[name].source})")
        reaches = importer.reaches(files)
        problems: list[str] = []
        with progress(f"importing {name}", len(reaches)) as update:
            import_dataset(
                importer, reaches, imported, load_objects("ycb"), ImportOptions(), ["ycb"],
                problems, on_progress=lambda: update(advance=1),
            )  # fmt: skip
        if problems:
            inform(f"{name}: {len(problems)} reaches left out, the first: {problems[0]:.200}")
    return imported


def _files_digest(folder: Path) -> str:
    """Return what changes when files below a folder do, or igrip."""
    found = hashlib.sha256(__version__.encode())
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        status = path.stat()
        found.update(f"{path} {status.st_size} {status.st_mtime_ns}\n".encode())
    return found.hexdigest()[:8]
