"""The command group. A command's module is imported only when that command is used."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence
from typing import Annotated, Any, NoReturn

import typer
from typer.core import TyperCommand, TyperGroup

from igrip.cli.ending import end
from igrip.cli.log_lines import print_own
from igrip.errors import IgripError
from igrip.version import __version__

# the first line of each docstring; a test keeps the two equal
COMMANDS = {
    "demo": "Watch igrip predict what a simulated person reaches for, and with which grip.",
    "replay": "Run estimators over recordings and summarise their predictions.",
    "evaluate": "Evaluate estimators over a dataset: summary.json, trials.parquet, report.html, "
    "figures.",
    "benchmark": "Judge estimators, igrip's own and others, over sets of reaches: one table.",
    "tune": "Tune commitments to one person, from 8 to 50 of their trials, or to a cohort.",
    "simulate": "Simulate the paper's protocol: people × 128 trials × 2 cameras, in random order.",
    "stream": "Receive observations from other programs and send them intentions, until Ctrl-C.",
    "view": "Look at a recording in the browser: play, pause, step, and go to any time.",
    "live": "Watch a camera and predict what each hand is about to grasp, and with which grip.",
    "drive": "Let a device act on leases: dry by default, with --arm for real.",
    "certify": "Measure latencies and times to stop on this machine, and judge them by your "
    "limits.",
    "experiment": "Run a study with people: plan, screens, recordings, and a dataset for igrip "
    "evaluate.",
    "record": "Record colour, depth and intrinsics of cameras.",
    "scan": "Make a model of your own thing from turning it before a camera with depth.",
    "calibrate": "Find where cameras stand from a board of AprilTags that lies still where all of "
    "them see it.",
    "import": "Turn motion-capture tables into a dataset.",
    "export": "Write a dataset in another format, to publish it or to read it elsewhere.",
    "check": "Check a dataset: every trial, its recording, hand, target and models.",
    "bench": "Measure the speed of the estimator on this machine.",
    "list": "List the names that options take: estimators, cues, cameras, models and more.",
    "doctor": "Show what is installed and whether the core works.",
    "grips": "Show from which height on each object is pinched.",
    "schema": "Print the JSON schema of a message.",
}  # fmt: skip
TARGETS = {
    "import": "importing:import_tables",
    "list": "listing:list_names",
}  # where it is not "NAME:NAME"
RENAMED_OPTIONS = {
    "live": {"--tell": "--out", "--apart": "--separate-hands", "--catalog": "--objects"},
}


def target_of(name: str) -> tuple[str, str]:
    """Return the module of a command and the function in it."""
    module, function = TARGETS.get(name, f"{name}:{name}").split(":")
    return f"igrip.cli.{module}", function


class RenamingCommand(TyperCommand):
    """A command that refuses an option of earlier versions and names the new one."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments, unless one has an old name."""
        for argument in args:
            old = argument.partition("=")[0]
            if new := RENAMED_OPTIONS.get(self.name or "", {}).get(old):
                raise IgripError(f"{old} was renamed to {new}")
        return super().parse_args(ctx, args)


class LazyGroup(TyperGroup):
    """A group that lists its commands without importing them."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands: Any = COMMANDS  # what a mistyped name is compared with

    def main(
        self, args: Sequence[str] | None = None, prog_name: str | None = None,
        complete_var: str | None = None, standalone_mode: bool = True,
        windows_expand_args: bool = True, **extra: Any,
    ) -> NoReturn:  # fmt: skip
        """Run the command that the arguments name, and exit as every command does."""
        arguments = list(sys.argv[1:] if args is None else args)

        def run() -> None:
            print_own()
            with self.make_context("igrip", arguments, **extra) as context:
                self.invoke(context)

        end(run)

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Import the module of one command and return the command; None if there is none."""
        if cmd_name not in COMMANDS:
            return None
        module, function = target_of(cmd_name)
        command = getattr(importlib.import_module(module), function)
        if isinstance(command, typer.Typer):
            group = typer.main.get_command(command)
            group.name = cmd_name
            return group
        single = typer.Typer(add_completion=False, rich_markup_mode=None)
        single.command(cmd_name, cls=RenamingCommand)(command)
        return typer.main.get_command(single)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the table of commands from their short helps."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


app = typer.Typer(
    name="igrip",
    cls=LazyGroup,
    help="Predict which object each moving hand will grasp, with which grip, and when.",
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
