"""``igrip doctor``: what is installed here, and whether the core works."""

from __future__ import annotations

import os
import platform
import re
import sys
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from igrip.cli.console import output, print_json
from igrip.compiled import cache_directory, kernel_cache_directory
from igrip.config import Config
from igrip.estimator import Estimator
from igrip.objects.catalog import PAPER_OBJECTS, load_objects
from igrip.observation import Observation
from igrip.version import __version__

EXTRA = re.compile(r"extra == ['\"](.+?)['\"]")


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _packages() -> dict[str | None, dict[str, str | None]]:
    """Return the packages that igrip's metadata name, by extra, and their versions here."""
    packages: dict[str | None, dict[str, str | None]] = {None: {}}
    try:
        requirements = requires("igrip") or []
    except PackageNotFoundError:  # run from its sources, never installed
        requirements = []
    for requirement in requirements:
        match = EXTRA.search(requirement)
        name = re.split(r"[^\w.-]", requirement)[0]
        packages.setdefault(match and match[1], {})[name] = _version(name)
    return packages


def _kernel() -> str:
    """Run one reach through the estimator; return how long the first frames took."""
    model = "cylinder:0.03x0.12"
    pose = {"model": model, "position": [0.5, 0.0, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}
    estimator = Estimator(load_objects(model), Config(targets="paper"))
    begin = time.perf_counter()
    for k in range(10):
        hands = {"right": {"position": [0.03 * k, 0.0, 0.0]}}
        estimator.update(Observation(t=k / 30, hands=hands, objects={"thing": pose}))
    return f"ten frames in {time.perf_counter() - begin:.2f} s, compilation included"


def _models() -> str:
    catalog = load_objects("ycb")
    for name in PAPER_OBJECTS:
        catalog[name]
    return f"{len(catalog)} meshes of the YCB set, the paper's four built"


def _check(work: Callable[[], str]) -> dict[str, Any]:
    try:
        return {"ok": True, "detail": work()}
    except Exception as error:  # whatever is broken here is what the doctor is asked for
        return {"ok": False, "detail": f"{type(error).__name__}: {error}"}


def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for a program.")] = False,
) -> None:
    """Show what is installed and whether the core works.

    Exit code 0: the core works; 1: it does not.

    Example: igrip doctor --json
    """
    packages = _packages()
    report: dict[str, Any] = {
        "igrip": __version__,
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "cache": str(cache_directory()),
        "kernel_cache": str(kernel_cache_directory()),
        "core": packages.pop(None),
        "extras": packages,
        "checks": {"kernel": _check(_kernel), "objects": _check(_models)},
    }
    works = all(check["ok"] for check in report["checks"].values())
    report["ok"] = works and all(report["core"].values())
    if as_json:
        print_json(report)
    else:
        _print(report)
    raise typer.Exit(0 if report["ok"] else 1)


def _print(report: dict[str, Any]) -> None:
    table = Table("", "what", "found", box=None)
    for name in ("igrip", "python", "platform", "processors", "cache"):
        table.add_row("", name, str(report[name]))
    for package, installed in report["core"].items():
        table.add_row(_mark(bool(installed)), package, installed or "missing: pip install igrip")
    for extra, packages in report["extras"].items():
        hint = f"not installed: pip install 'igrip[{extra}]'"
        for package, installed in packages.items():
            table.add_row(_mark(bool(installed), "-"), f"{package} ({extra})", installed or hint)
    for name, check in report["checks"].items():
        table.add_row(_mark(check["ok"]), name, check["detail"])
    output.print(table)
    if report["ok"]:
        output.print("The core works.")
    else:
        output.print("The core does not work.", style="bold red")


def _mark(good: bool, otherwise: str = "✗") -> Text:
    return Text("✓", "green") if good else Text(otherwise, "red")
