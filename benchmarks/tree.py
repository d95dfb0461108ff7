"""Files and lines per package of one or more checkouts: ``python -m benchmarks.tree [ROOT …]``."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from pathlib import Path
from statistics import median
from typing import Annotated, NamedTuple

import typer
from rich.table import Table

from igrip.cli.console import output

MAX_LINES = 300  # no file of src/igrip may be longer


class Size(NamedTuple):
    """The lines of each file of a package."""

    lines: tuple[int, ...]

    def row(self) -> tuple[str, ...]:
        """Return files, lines, median and longest file, for a table."""
        middle = f"{median(self.lines):.0f}" if self.lines else "-"
        longest = str(max(self.lines, default=0))
        return str(len(self.lines)), str(sum(self.lines)), middle, longest


def files(root: Path) -> dict[str, dict[Path, int]]:
    """Return the number of lines of each Python file of ``src/igrip``, by package.

    A module at the top is a package of its own.
    """
    packages: dict[str, dict[Path, int]] = defaultdict(dict)
    folder = root / "src" / "igrip"
    for path in sorted(folder.rglob("*.py")):
        name = path.relative_to(folder).parts[0].removesuffix(".py")
        packages[name][path] = len(path.read_text(encoding="utf-8").splitlines())
    return packages


def core(root: Path) -> set[str]:
    """Return the packages of the core, as the import contract of the checkout lists them."""
    settings = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    for contract in settings["tool"]["importlinter"]["contracts"]:
        if contract["type"] == "forbidden":
            return {module.removeprefix("igrip.") for module in contract["source_modules"]}
    raise ValueError(f"{root}: pyproject.toml has no contract that defines the core")


def table(root: Path) -> Table:
    """Return the table of one checkout: the core's modules, then the edges, then the sums."""
    packages = {name: Size(tuple(lines.values())) for name, lines in files(root).items()}
    of_core = core(root)
    made = Table("", "package", title=str(root))
    for column in ("files", "lines", "median", "longest"):
        made.add_column(column, justify="right")
    groups: dict[str, list[Size]] = {"core": [], "edge": []}
    for name, size in sorted(packages.items(), key=lambda item: (item[0] not in of_core, item[0])):
        group = "core" if name in of_core else "edge"
        groups[group].append(size)
        made.add_row(group, name, *size.row())
    made.add_section()
    for group, sizes in [*groups.items(), ("all", [*packages.values()])]:
        total = Size(tuple(count for size in sizes for count in size.lines))
        made.add_row(group, "", *total.row())
    return made


def main(
    roots: Annotated[list[Path] | None, typer.Argument(help="Checkouts. Default: this.")] = None,
) -> None:
    """Print a table of files and lines for each checkout.

    Example: python -m benchmarks.tree ../old .
    """
    for root in roots or [Path(__file__).parents[1]]:
        output.print(table(root))


if __name__ == "__main__":
    typer.run(main)
