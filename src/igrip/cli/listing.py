"""``igrip list``: the names that options take."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, NamedTuple

import typer

from igrip.cli import options
from igrip.cli.console import output, print_json, table_of
from igrip.cues import CUES
from igrip.devices import DEVICES
from igrip.errors import UnknownNameError
from igrip.grips import GRIPS
from igrip.io.exporters import EXPORTERS
from igrip.io.importers import IMPORTERS
from igrip.io.layouts import LAYOUTS
from igrip.io.recordings import SOURCES
from igrip.lab.simulation.faults import KINDS
from igrip.lab.simulation.parameters import PROFILES
from igrip.objects.catalog import load_objects
from igrip.perception.cameras import CAMERAS
from igrip.perception.hands import HANDS
from igrip.perception.poses import POSES
from igrip.runtime.inputs import INPUTS
from igrip.runtime.outputs import OUTPUTS
from igrip.targets import TARGETS


class Family(NamedTuple):
    """Names of one kind, and where they are used."""

    names: Callable[[], Sequence[str]]
    used: str


FAMILIES = {
    "targets": Family(TARGETS.names, "--targets, Config(targets=…)"),
    "cues": Family(CUES.names, "scores of an intention"),
    "grips": Family(GRIPS.names, "evaluate --grips, Config(grips=…)"),
    "cameras": Family(CAMERAS.names, "--camera"),
    "hands": Family(HANDS.names, "live --hands"),
    "poses": Family(POSES.names, "live --poses"),
    "inputs": Family(INPUTS.names, "stream --in"),
    "outputs": Family(OUTPUTS.names, "stream --out, live --out"),
    "devices": Family(DEVICES.names, "drive --device"),
    "recordings": Family(SOURCES.names, "endings of recordings, and ros2 folders"),
    "importers": Family(IMPORTERS.names, "import, recognised by what files hold"),
    "exporters": Family(EXPORTERS.names, "export --format"),
    "layouts": Family(LAYOUTS.names, "import, recognised by what files hold"),
    "faults": Family(lambda: sorted(KINDS), "demo --fault"),
    "profiles": Family(lambda: tuple(PROFILES), "simulate --profile"),
}
MODELS = "models"
SHOWN = 6  # models in the table of all


def list_names(
    family: Annotated[
        str | None, typer.Argument(help=f"One of: {', '.join((*FAMILIES, MODELS))}. Default: all.")
    ] = None,
    objects: options.Objects = None,
    as_json: options.Json = False,
) -> None:
    """List the names that options take: estimators, cues, cameras, models and more.

    Other distributions add names; see CONTRIBUTING.md. Models are those of --objects.

    Example: igrip list targets
    """
    families = (*FAMILIES, MODELS)
    if family is not None and family not in families:
        raise UnknownNameError("family", family, families)
    names = {name: list(one.names()) for name, one in FAMILIES.items() if family in (None, name)}
    if family in (None, MODELS):
        names[MODELS] = sorted(load_objects(*(objects or ["ycb"])))
    if as_json:
        print_json(names)
    elif family is not None:
        output.print("\n".join(names[family]), soft_wrap=True)
    else:
        rows = [(name, ", ".join(listed), FAMILIES[name].used)
                for name, listed in names.items() if name != MODELS]  # fmt: skip
        models = names[MODELS]
        more = f", … ({len(models)} in all: igrip list models)" if len(models) > SHOWN else ""
        used = "--model, --mesh, an object's model"
        rows.append((MODELS, ", ".join(models[:SHOWN]) + more, used))
        output.print(table_of(("family", "names", "used in"), rows, left=(1, 2)))
