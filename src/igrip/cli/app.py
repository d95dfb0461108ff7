"""The application the subcommands belong to."""

from __future__ import annotations

from typing import Annotated

import typer

from igrip.cli import (
    bench,
    calibrate,
    demo,
    doctor,
    evaluate,
    grips,
    importing,
    live,
    record,
    replay,
    schema,
    simulate,
    stream,
    view,
)
from igrip.cli.console import output
from igrip.version import __version__

app = typer.Typer(
    name="igrip",
    help="From where the hands are and where things are, to what each hand will grasp, and how.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(asked: bool) -> None:
    if asked:
        output.print(f"igrip {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Say the version.")
    ] = False,
) -> None:
    """Options of every command."""


app.command("demo")(demo.demo)
app.command("replay")(replay.replay)
app.command("evaluate")(evaluate.evaluate)
app.command("simulate")(simulate.simulate)
app.command("stream")(stream.stream)
app.command("view")(view.view)
app.command("live")(live.live)
app.command("record")(record.record)
app.command("calibrate")(calibrate.calibrate)
app.command("import")(importing.import_tables)
app.command("bench")(bench.bench)
app.command("doctor")(doctor.doctor)
app.command("grips")(grips.grips)
app.command("schema")(schema.schema)
