"""``igrip doctor``: what is installed here, and whether the core works."""

from __future__ import annotations

import os
import platform
import re
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from igrip.cli import options
from igrip.cli.console import output, print_json
from igrip.cli.estimator_setup import warm_up
from igrip.compiled import cache_directory, kernel_cache_directory
from igrip.config import Config
from igrip.errors import MissingExtraError, install_command
from igrip.grips import GRIPS
from igrip.objects.catalog import PAPER_OBJECTS, load_objects
from igrip.targets import TARGETS
from igrip.version import __version__

EXTRA = re.compile(r"""extra == ["']([^"']+)""")


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def dependencies() -> dict[str, dict[str, str | None]]:
    """Return the installed version of each dependency, by extra; those of the core under "".

    They are read from the metadata of the installed package, and are none in a bare source tree.
    """
    try:
        requirements = requires("igrip") or []
    except PackageNotFoundError:
        requirements = []
    versions: dict[str, dict[str, str | None]] = {"": {}}
    for requirement in requirements:
        package = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
        extra = EXTRA.search(requirement)
        versions.setdefault(extra[1] if extra else "", {})[package] = _version(package)
    return versions


def _check_kernel() -> str:
    """Run one reach through the estimator; return how long the first frames took."""
    begin = time.perf_counter()
    warm_up(Config(targets="paper"), load_objects("cylinder:0.03x0.12"))
    return f"a reach in {time.perf_counter() - begin:.2f} s, compilation included"


def _warm_up() -> str:
    """Compile every kernel that commands run, and build the paper's models; return the time."""
    begin = time.perf_counter()
    catalog = load_objects("ycb")
    for name in PAPER_OBJECTS:
        catalog[name]
    compiled = [f"{len(TARGETS.names())} targets estimators"]
    for targets in TARGETS.names():
        for grips in GRIPS.names():
            warm_up(Config(targets=targets, grips=grips), load_objects("cylinder:0.03x0.12"))
    with suppress(MissingExtraError):
        _warm_up_poses()
        compiled.append("poses from depth")
    seconds = time.perf_counter() - begin
    return f"{', '.join(compiled)}, the paper's four meshes: {seconds:.1f} s, kept in the cache"


def _warm_up_poses() -> None:
    """Run the pose estimator on rendered frames."""
    from igrip.perception.pipeline.stages import object_stages, warm_up_stages

    catalog = load_objects("ycb")
    options = {"models": list(PAPER_OBJECTS)}
    warm_up_stages(None, object_stages("depth", catalog, options), catalog, list(PAPER_OBJECTS))


def _check_objects() -> str:
    """Build the models of the paper's objects; return how many meshes there are."""
    catalog = load_objects("ycb")
    for name in PAPER_OBJECTS:
        catalog[name]
    return f"{len(catalog)} meshes of the YCB set, the paper's four built"


def _result(check: Callable[[], str]) -> dict[str, Any]:
    try:
        return {"ok": True, "detail": check()}
    except Exception as error:  # any failure is a finding to report
        return {"ok": False, "detail": f"{type(error).__name__}: {error}"}


def doctor(
    warm: Annotated[
        bool,
        typer.Option("--warm-up", help="Also compile all kernels and build the paper's models now, "
                     "so that no later command has to."),
    ] = False,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Show what is installed and whether the core works.

    Kernels are compiled once for each version of igrip on a machine, and kept in its cache. Exit
    code 0: the core works; 1: it does not.

    Example: igrip doctor --warm-up
    """
    warmed = {"warm-up": _result(_warm_up)} if warm else {}
    checks = warmed | {"kernel": _result(_check_kernel), "objects": _result(_check_objects)}
    extras = dependencies()
    report: dict[str, Any] = {
        "igrip": __version__,
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "cache": str(cache_directory()),
        "kernel_cache": str(kernel_cache_directory()),
        "core": extras.pop(""),
        "extras": extras,
        "checks": checks,
    }
    works = all(check["ok"] for check in checks.values()) and all(report["core"].values())
    report["ok"] = works
    if as_json:
        print_json(report)
    else:
        _print(report)
    raise typer.Exit(0 if works else 1)


def _print(report: dict[str, Any]) -> None:
    table = Table("", "component", "status", box=None)
    table.columns[1].overflow = table.columns[-1].overflow = "fold"
    for name in ("igrip", "python", "platform", "processors", "cache"):
        table.add_row("", name, str(report[name]))
    for package, installed in report["core"].items():
        status = installed or f"missing: pip install '{package}'"
        table.add_row(_mark(installed is not None), package, status)
    for extra, packages in report["extras"].items():
        for package, installed in packages.items():
            status = installed or f"not installed: {install_command(extra)}"
            table.add_row(_mark(installed is not None, "-"), f"{package} ({extra})", status)
    for name, check in report["checks"].items():
        table.add_row(_mark(check["ok"]), name, check["detail"])
    output.print(table)
    if report["ok"]:
        output.print("The core works.")
    else:
        output.print("The core does not work.", style="bold red")


def _mark(ok: bool, otherwise: str = "✗") -> Text:
    return Text("✓", "green") if ok else Text(otherwise, "red")
