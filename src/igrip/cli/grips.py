"""``igrip grips``: the grip zones of objects, in numbers, as a picture and as a page."""

from __future__ import annotations

import threading
from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import errors, output, print_json, until_interrupted
from igrip.cli.outputs import file_option, free_port
from igrip.config import Config
from igrip.objects.catalog import PAPER_OBJECTS, load_objects
from igrip.viewer.grasp_lines import grasp_rows
from igrip.viewer.grip_figure import draw_grip_zones
from igrip.viewer.grip_page import GripPage


def grips(
    models: Annotated[
        list[str] | None, typer.Argument(help="Names of models. Default: the paper's four, or all.")
    ] = None,
    objects: options.Objects = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Write the picture here (.png, .svg, .pdf).",
                     callback=file_option(".png", ".svg", ".pdf")),
    ] = None,
    page: Annotated[
        bool,
        typer.Option("--page", help="Show the zones and the grasp candidates on the meshes in the "
                     "browser, until Ctrl-C."),
    ] = False,
    candidates: Annotated[
        bool, typer.Option("--candidates", help="List the grasp candidates of each mesh, too.")
    ] = False,
    port: options.PagePort = 8080,
    as_json: options.Json = False,
) -> None:  # fmt: skip
    """Show from which height on each object is pinched.

    Example: igrip grips --out figure2.png
    """
    if page:
        port = free_port(port)
    catalog = load_objects(*(objects or ["ycb"]))
    default = PAPER_OBJECTS if set(PAPER_OBJECTS) <= set(catalog) else tuple(catalog)
    chosen = [catalog[name] for name in models or default]
    pinch_from = Config().grip.pinch_threshold
    borders = {model.name: pinch_from * 0.5 * model.length for model in chosen}
    if out is not None:
        draw_grip_zones(chosen, pinch_from, out)
    grasps = {model.name: grasp_rows(model) for model in chosen} if candidates else {}
    if as_json:
        found = {"candidates": grasps} if candidates else {}
        print_json({"pinch_from_half_lengths": pinch_from, "border_m": borders, **found})
    else:
        for name, border in borders.items():
            output.print(f"{name}: pinch beyond {1e3 * border:.1f} mm from the middle")
            for row in grasps.get(name, ()):
                turns = ", any turn" if row["turns"][1] > row["turns"][0] else ""
                output.print(
                    f"  {row['grip']} at the {row['part']}, {1e3 * row['opening']:.0f} mm wide, "
                    f"prior {row['weight']:.2f}{turns}"
                )
    if page:
        with closing(GripPage(chosen, pinch_from, port=port)) as shown, until_interrupted():
            errors.print(f"The grip zones are at {shown.url}; Ctrl-C to stop")
            threading.Event().wait()
