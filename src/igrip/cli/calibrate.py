"""``igrip calibrate``: where cameras stand, from a board of tags."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output, warn
from igrip.cli.outputs import file_option
from igrip.errors import CameraError, IgripError
from igrip.perception.calibration.board import Board
from igrip.perception.calibration.extrinsics import locate_camera, watch_board
from igrip.perception.calibration.lens import calibrate_lens
from igrip.perception.cameras import open_camera, split_names
from igrip.perception.lens import write_lens
from igrip.perception.placements import Placement, write_placements

DEPTH_TOLERANCE = 0.03  # of a camera's depth against the board's, before it is mentioned


def calibrate(
    camera: Annotated[
        str | None, typer.Option(help="Cameras that see the board, joined by +: oak:ID1+oak:ID2.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="The file to write (.json).", callback=file_option()),
    ] = None,
    lens: Annotated[
        Path | None,
        typer.Option(help="Calibrate the lens of one camera instead, for ?intrinsics=, and write "
                     "it here (.json); move the board about.", callback=file_option()),
    ] = None,
    board: Annotated[
        Path | None,
        typer.Option(help="Write the board here (.svg), to be printed at 100 %.",
                     callback=file_option()),
    ] = None,
    tag_size: Annotated[
        float,
        typer.Option(help="Of a tag's black square on paper [m]; measure it.", min=0.001, max=1.0),
    ] = Board().tag_size,
    columns: Annotated[int, typer.Option(help="Tags in a row.", min=1, max=20)] = Board().columns,
    rows: Annotated[int, typer.Option(help="Rows.", min=1, max=20)] = Board().rows,
    seconds: Annotated[
        float | None, typer.Option(help="Maximum duration [s]. Default: 5, for a lens 60.", min=0.1)
    ] = None,
) -> None:  # fmt: skip
    """Find where cameras stand from a board of AprilTags that lies still where all of them see it.

    The world then is the board's: its middle, x to its right, y to its top, z up. Use the file with
    --calibration.

    Example: igrip calibrate --board board.svg

    Example: igrip calibrate --camera oak:ID1+oak:ID2 --out cameras.json

    Example: igrip calibrate --camera webcam:0 --lens lens.json
    """
    printed = Board(columns=columns, rows=rows, tag_size=tag_size)
    if board is not None:
        _draw(board, printed)
    if camera is None:
        if board is None:
            raise IgripError("name the cameras (--camera), or a file for the board (--board)")
        return
    if lens is not None:
        _calibrate_lens(camera, lens, printed, seconds or 60.0)
        return
    if out is None:
        raise IgripError("name the file to write (--out)")
    with closing(open_camera(camera)) as device, errors.status("watching the board …"):
        if note := getattr(device, "note", None):
            warn(note)
        views = watch_board(device, printed, seconds or 5.0, len(split_names(camera)))
    if len(views) < len(split_names(camera)):
        raise CameraError(f"only {', '.join(views) or 'none'} of the cameras sent pictures")
    placements = {name: locate_camera(name, view, printed) for name, view in views.items()}
    write_placements(out, placements, printed.model_dump())
    for name, placement in placements.items():
        _print_placement(name, placement)
    output.print(f"{out}: {len(placements)} cameras", soft_wrap=True)


def _draw(path: Path, board: Board) -> None:
    if path.suffix.lower() != ".svg":
        raise IgripError(f"{path}: the board is written as .svg")
    try:
        path.write_text(board.svg(), encoding="utf-8")
    except OSError as error:
        raise IgripError(f"{path}: {error.strerror or error}") from error
    output.print(f"{path}: print it at 100 %, measure a black square, glue it on something flat")


def _calibrate_lens(camera: str, path: Path, board: Board, seconds: float) -> None:
    advice = "move the board about the whole picture, near and far, tilted …"
    with closing(open_camera(camera)) as device, errors.status(advice):
        result = calibrate_lens(device, board, seconds)
    write_lens(path, result.lens, result.error)
    pinhole = result.lens.intrinsics
    output.print(
        f"{path}: f {pinhole.fx:.1f}, {pinhole.fy:.1f}, centre {pinhole.cx:.1f}, {pinhole.cy:.1f} "
        f"pixels of {pinhole.width} × {pinhole.height}; {result.views} pictures, "
        f"{result.error:.2f} pixels",
        soft_wrap=True,
    )


def _print_placement(name: str, placement: Placement) -> None:
    x, y, z = placement.world_from_camera[:3, 3]
    output.print(
        f"{name}: at ({x:.3f}, {y:.3f}, {z:.3f}) m ± {1000 * placement.std:.1f} mm, "
        f"{placement.tags} tags in {placement.views} pictures, {placement.error:.2f} pixels",
        soft_wrap=True,
    )
    ratio = placement.depth_ratio
    if ratio is not None and abs(ratio - 1.0) > DEPTH_TOLERANCE:
        warn(
            f"{name}: by its depth the board is {ratio:.2f} times as far as by its tags: was it "
            "printed at another size (--tag-size)?"
        )
