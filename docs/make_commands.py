"""Make docs/commands.md: every command's help, and what an example prints: ``make commands``."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from igrip.cli.app import COMMANDS

PAGE = Path(__file__).with_name("commands.md")
HEAD = """# Commands

Made by `make commands`, which runs each of them. `igrip COMMAND --help` prints the same help.
Errors go to standard error in one line, with exit code 2 where something has to be changed before
the command can run. `--json`, where a command has it, prints one JSON object for a program.
"""
# run in this order in one folder: later ones use what earlier ones wrote
RUNS = (
    ("simulate", "cohort --participants 1 --trials 6 --no-reach 0 --seed 1"),
    ("check", "cohort"),
    ("replay", "cohort --targets bayes --targets paper"),
    ("evaluate", "cohort --out report --targets paper --targets bayes"),
    ("import", "--inspect take1.csv --input-rate 100 --unit mm"),
    ("grips", ""),
)
PARTS = {"experiment": ("new", "run", "review", "summary", "status")}  # commands of a command
ENVIRONMENT = {**os.environ, "COLUMNS": "96", "TERM": "dumb", "NO_COLOR": "1"}


def run(arguments: str, folder: Path) -> str:
    """Run igrip in a folder and return what it prints.

    Raises
    ------
    subprocess.CalledProcessError
        If it fails.
    """
    command = [sys.executable, "-m", "igrip", *arguments.split()]
    done = subprocess.run(
        command, cwd=folder, env=ENVIRONMENT, check=True, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    return done.stdout.replace(f"{folder}{os.sep}", "").replace("python -m igrip", "igrip").strip()


def write_take(path: Path) -> None:
    """Write a small table of positions at 100 Hz [mm], for the import."""
    rows = [f"{k},{200 - 1.5 * k:.1f},{3.5 * k:.1f},{50 + 0.4 * k:.1f}" for k in range(100)]
    path.write_text("\n".join(["frame,palm x,palm y,palm z", *rows]) + "\n")


def main() -> None:
    """Write the page."""
    lines = [HEAD]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_take(folder / "take1.csv")
        printed = {
            command: (arguments, run(f"{command} {arguments}", folder))
            for command, arguments in RUNS
        }
        for command in COMMANDS:
            lines += [f"## igrip {command}", "", "```text", run(f"{command} --help", folder), "```"]
            for part in PARTS.get(command, ()):
                lines += ["", "```text", run(f"{command} {part} --help", folder), "```"]
            if command in printed:
                arguments, text = printed[command]
                lines += ["", "```console", f"$ igrip {command} {arguments}".rstrip(), text, "```"]
            lines.append("")
    PAGE.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
