"""The command group. A command's module is imported only when that command is used."""

from __future__ import annotations

import importlib
from typing import Annotated, Any, NamedTuple

import typer
from typer.core import TyperGroup

from igrip.version import __version__


class Command(NamedTuple):
    """Where a command is implemented, and its line in ``igrip --help``."""

    target: str  # ``module:function`` within :mod:`igrip.cli`
    help: str  # the first line of the function's docstring; a test keeps the two equal


COMMANDS = {
    "demo": Command(
        "demo:demo",
        "Watch igrip predict what a simulated person reaches for, and with which grip.",
    ),
    "replay": Command("replay:replay", "Run estimators over recordings and summarise the answers."),
    "evaluate": Command(
        "evaluate:evaluate",
        "Evaluate estimators over a dataset: summary.json, trials.parquet, report.html, figures.",
    ),
    "simulate": Command(
        "simulate:simulate",
        "Simulate the paper's protocol: people × 128 trials × 2 cameras, in random order.",
    ),
    "stream": Command(
        "stream:stream",
        "Receive observations from other programs and send them intentions, until Ctrl-C.",
    ),
    "view": Command(
        "view:view",
        "Look at a recording in the browser: play, pause, step, and go to any time.",
    ),
    "live": Command(
        "live:live",
        "Watch a camera and predict what each hand is about to grasp, and with which grip.",
    ),
    "record": Command("record:record", "Record colour, depth and intrinsics of cameras."),
    "calibrate": Command(
        "calibrate:calibrate",
        "Find where cameras stand from a board of AprilTags that lies still where all of them "
        "see it.",
    ),
    "import": Command("importing:import_tables", "Turn motion-capture tables into a dataset."),
    "check": Command(
        "check:check", "Check a dataset: every trial, its recording, hand, target and models."
    ),
    "bench": Command("bench:bench", "Measure the speed of the estimator on this machine."),
    "doctor": Command("doctor:doctor", "Show what is installed and whether the core works."),
    "grips": Command("grips:grips", "Show from which height on each object is pinched."),
    "schema": Command("schema:schema", "Print the JSON schema of a message."),
}


class LazyGroup(TyperGroup):
    """A group that lists its commands without importing them."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands: Any = COMMANDS  # what a mistyped name is compared with

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import the module of one command and return the command; None if there is none."""
        if cmd_name not in COMMANDS:
            return None
        module, function = COMMANDS[cmd_name].target.split(":")
        single = typer.Typer(add_completion=False, rich_markup_mode=None)
        single.command(cmd_name)(getattr(importlib.import_module(f"igrip.cli.{module}"), function))
        return typer.main.get_command(single)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the table of commands from their short helps."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, command.help) for name, command in COMMANDS.items()])


app = typer.Typer(
    name="igrip",
    cls=LazyGroup,
    help="From where the hands are and where things are, to what each hand will grasp, and how.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _print_version(requested: bool) -> None:
    if requested:
        typer.echo(f"igrip {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options of every command."""
