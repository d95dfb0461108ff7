"""``igrip scan``: a model of one's own thing, from turning it before a camera with depth."""

from __future__ import annotations

import shlex
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer

from igrip.cli.console import errors, inform, output, warn
from igrip.cli.outputs import check_folder
from igrip.errors import IgripError
from igrip.objects.catalog import load_objects
from igrip.perception.cameras import Camera, open_camera, split_names
from igrip.perception.hands import HANDS, HandDetector, new_detector
from igrip.perception.scan.catalogue_entry import Scan, check_name, write_entry
from igrip.perception.scan.options import ScanOptions
from igrip.perception.scan.scanner import Scanner
from igrip.version import __version__

NOTHING = "none"
TURN_ON = "turn it on by about 30 degrees, take the hand away"


def scan(
    name: Annotated[str, typer.Argument(help="Of the model, such as my_mug.")],
    camera: Annotated[
        str, typer.Option(help="A camera with depth: oak, realsense, replay:FILE.mcap, or "
                          "'rendered?turn=025_mug' to try it without one.")
    ] = "oak",
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="Folder of meshes that it is added to; made if missing."),
    ] = Path("meshes"),
    hands: Annotated[
        str, typer.Option(help="Hand detector, to tell the hand from the thing: mediapipe; none: "
                          "by shape alone.")
    ] = NOTHING,
    round_thing: Annotated[
        bool,
        typer.Option("--round", help="It looks the same from all sides, as a can: one view is "
                     "enough."),
    ] = False,
    stand: Annotated[
        float, typer.Option(help="Height of the turntable under it [m].", min=0.0, max=0.3)
    ] = 0.0,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace a model of this name.")
    ] = False,
) -> None:  # fmt: skip
    """Make a model of your own thing from turning it before a camera with depth.

    Put the thing alone on the table. Turn it by about 30 degrees, take the hand away for a second,
    and so on, all the way round; or let a turntable turn it. Mesh (metres, z up, origin under its
    middle), picture and objects.toml go to a folder that --objects takes.

    Example: igrip scan my_mug --camera oak --out meshes

    Example: igrip live --camera oak --objects meshes --model my_mug --poses depth
    """
    check_folder(out)
    check_name(out, name, replace)
    if len(split_names(camera)) > 1:
        raise IgripError("a scan needs one camera: it is the thing that turns")
    if hands != NOTHING:
        HANDS.check(hands)
    scanner = Scanner(ScanOptions(stand=stand), round_thing)
    with closing(open_camera(camera)) as source:
        if note := getattr(source, "note", None):
            warn(note)
        detector = None if hands == NOTHING else new_detector(hands)
        try:
            _gather(source, detector, scanner)
        finally:
            if detector is not None:
                detector.close()
    with errors.status("making the mesh …"):
        mesh = scanner.mesh()
        size = [round(float(edge), 4) for edge in mesh.extents]
        about: dict[str, Any] = {
            "name": name, "views": 1 if round_thing else len(scanner.views), "round": round_thing,
            "camera": scanner.camera, "size_m": size, "triangles": len(mesh.faces),
            "frame": "metres, z up, origin on the table under the middle", "igrip": __version__,
        }  # fmt: skip
        path = write_entry(out, name, Scan(mesh, scanner.picture(), round_thing, about))
        load_objects(out)[name]
    sides = " × ".join(f"{1e3 * edge:.0f}" for edge in size)
    output.print(f"{path}: {sides} mm, {about['views']} views, {about['triangles']} triangles")
    live = ["igrip", "live", "--camera", camera, "--objects", str(out), "--model", name]
    output.print(shlex.join([*live, "--poses", "depth"]), soft_wrap=True)


def _gather(camera: Camera, detector: HandDetector | None, scanner: Scanner) -> None:
    """Take frames until the thing was seen from all sides, or there are no more."""
    show = errors.status("waiting for the first frame …") if errors.is_terminal else nullcontext()
    with show as status:
        for frame in camera:
            found = [] if detector is None or frame.depth is None else detector.detect(frame)
            if scanner.add(frame, [hand.landmarks for hand in found]):
                inform(_progress(scanner))
            if scanner.done:
                return
            if status is not None:
                status.update(f"{scanner.problem or TURN_ON}; Ctrl-C ends")


def _progress(scanner: Scanner) -> str:
    return f"view {len(scanner.views)}, {scanner.degrees:.0f} of 360 degrees seen"
