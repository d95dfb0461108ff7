"""``igrip calibrate``: where cameras stand, from a board of tags."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output
from igrip.errors import IgripError
from igrip.perception.calibration.board import Board
from igrip.perception.calibration.extrinsics import (
    Placement,
    collect,
    place_camera,
    write_calibration,
)
from igrip.perception.calibration.lens import find_lens
from igrip.perception.cameras import CameraError, open_camera, split_names

ODD_DEPTH = 0.03  # a camera's depth may differ so much from the board's before it is mentioned


def calibrate(
    camera: Annotated[
        str | None, typer.Option(help="Cameras that see the board, joined by +: oak:ID1+oak:ID2.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="The file to write (.json).")
    ] = None,
    lens: Annotated[
        Path | None,
        typer.Option(help="Find the lens of one camera instead, for ?intrinsics=, and write it "
                     "here (.json); move the board about."),
    ] = None,
    board: Annotated[
        Path | None, typer.Option(help="Write the board here (.svg), to be printed at 100 %.")
    ] = None,
    tag_size: Annotated[
        float,
        typer.Option(help="Of a tag's black square on paper [m]; measure it.", min=0.001, max=1.0),
    ] = Board().tag_size,
    columns: Annotated[int, typer.Option(help="Tags in a row.", min=1, max=20)] = Board().columns,
    rows: Annotated[int, typer.Option(help="Rows.", min=1, max=20)] = Board().rows,
    seconds: Annotated[
        float | None, typer.Option(help="At most so long. Default: 5, for a lens 60.", min=0.1)
    ] = None,
) -> None:  # fmt: skip
    """Find where cameras stand from a board of AprilTags that lies still where all of them see it.

    The world then is the board's: its middle, x to its right, y to its top, z up. Use the file with
    --calibration.

    Example: igrip calibrate --board board.svg

    Example: igrip calibrate --camera oak:ID1+oak:ID2 --out cameras.json

    Example: igrip calibrate --camera webcam:0 --lens lens.json
    """
    described = Board(columns=columns, rows=rows, tag_size=tag_size)
    if board is not None:
        _draw(board, described)
    if camera is None:
        if board is None:
            raise IgripError("name the cameras (--camera), or a file for the board (--board)")
        return
    if lens is not None:
        _find_lens(camera, lens, described, seconds or 60.0)
        return
    if out is None:
        raise IgripError("name the file to write (--out)")
    device = open_camera(camera)
    try:
        if note := getattr(device, "note", None):
            errors.print(note, style="yellow", soft_wrap=True)
        with errors.status("looking at the board …"):
            views = collect(device, described, seconds or 5.0, len(split_names(camera)))
    finally:
        device.close()
    if len(views) < len(split_names(camera)):
        raise CameraError(f"only {', '.join(views) or 'none'} of the cameras sent pictures")
    placements = {name: place_camera(name, seen, described) for name, seen in views.items()}
    write_calibration(out, placements, described)
    for name, placed in placements.items():
        _say(name, placed)
    output.print(f"{out}: {len(placements)} cameras", soft_wrap=True)


def _draw(path: Path, board: Board) -> None:
    if path.suffix.lower() != ".svg":
        raise IgripError(f"{path}: the board is written as .svg")
    try:
        path.write_text(board.svg(), encoding="utf-8")
    except OSError as error:
        raise IgripError(f"{path}: {error.strerror or error}") from error
    output.print(f"{path}: print it at 100 %, measure a black square, glue it on something flat")


def _find_lens(camera: str, path: Path, board: Board, seconds: float) -> None:
    device = open_camera(camera)
    try:
        with errors.status("move the board about the whole picture, near and far, tilted …"):
            found = find_lens(device, board, seconds)
    finally:
        device.close()
    found.write(path)
    own = found.intrinsics
    output.print(
        f"{path}: f {own.fx:.1f}, {own.fy:.1f}, centre {own.cx:.1f}, {own.cy:.1f} pixels of "
        f"{own.width} × {own.height}; {found.views} pictures, {found.error:.2f} pixels",
        soft_wrap=True,
    )


def _say(name: str, placed: Placement) -> None:
    x, y, z = placed.world_from_camera[:3, 3]
    output.print(
        f"{name}: at ({x:.3f}, {y:.3f}, {z:.3f}) m ± {1000 * placed.std:.1f} mm, "
        f"{placed.tags} tags in {placed.views} pictures, {placed.error:.2f} pixels",
        soft_wrap=True,
    )
    if placed.depth_ratio is not None and abs(placed.depth_ratio - 1.0) > ODD_DEPTH:
        errors.print(
            f"{name}: its depth says that the board is {placed.depth_ratio:.2f} times as far as "
            "its tags say: was it printed at another size (--tag-size)?",
            style="yellow",
            soft_wrap=True,
        )
