"""``igrip record``: camera frames into a file that Foxglove and igrip read."""

from __future__ import annotations

import time
from contextlib import closing, suppress
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli import options
from igrip.cli.console import errors, output, warn
from igrip.cli.outputs import file_option
from igrip.errors import RecordingError
from igrip.io.mcap.frame_recorder import FrameRecorder
from igrip.io.mcap.writer import McapWriter
from igrip.perception.cameras import Camera, CameraError, open_camera

STATUS_EVERY = 0.25  # s


def record(
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="The file to write (.mcap).", callback=file_option()),
    ],
    camera: Annotated[
        str,
        typer.Option(help="oak, realsense, webcam:0, replay:FILE; several joined by +."),
    ] = "oak",
    seconds: Annotated[
        float | None, typer.Option(help="Duration [s]. Default: until Ctrl-C.", min=0.0)
    ] = None,
    calibration: options.Calibration = None,
    lossless: Annotated[
        bool, typer.Option("--lossless", help="Colour as PNG; slower, and several times larger.")
    ] = False,
) -> None:
    """Record colour, depth and intrinsics of cameras.

    Frames that cannot be written in time are dropped and counted. A kill or a pulled cable costs at
    most the last half second. Exit code 1: a camera failed; the frames before that are in the file.

    Example: igrip record --camera oak --out table.mcap --seconds 30
    """
    if out.suffix.lower() != ".mcap":
        raise RecordingError(f"{out}: frames are recorded as .mcap")
    with closing(open_camera(camera, calibration)) as device:
        if note := getattr(device, "note", None):
            warn(note)
        with McapWriter(out, lossless=lossless) as writer:
            failure = _record(device, writer, seconds)
    if failure is not None:
        errors.print(f"igrip: {failure}", style="red", soft_wrap=True)
        raise typer.Exit(1)


def _record(camera: Camera, writer: McapWriter, seconds: float | None) -> CameraError | None:
    """Record until the end, and return the error of a camera that failed."""
    recorder, failure = FrameRecorder(writer), None
    first = last = 0.0
    updated = time.monotonic()
    with errors.status("waiting for the first frame …") as status:
        try:
            for frame in camera:
                first = frame.t if not recorder.received else first
                if seconds is not None and frame.t - first > seconds:
                    break
                last = max(last, frame.t)
                recorder.add(frame)
                if time.monotonic() - updated >= STATUS_EVERY:
                    updated = time.monotonic()
                    status.update(f"{_summary(recorder, writer, last - first)}; Ctrl-C ends")
        except KeyboardInterrupt:
            pass
        except CameraError as error:
            failure = error
            with suppress(RecordingError):
                writer.write_event(last, "camera failed", message=str(error))
        finally:
            camera.close()
            try:
                recorder.close()
            finally:  # print what is in the file even if the disk is full
                summary = _summary(recorder, writer, last - first)
                output.print(f"{writer.path}: {summary}", soft_wrap=True)
    return failure


def _summary(recorder: FrameRecorder, writer: McapWriter, seconds: float) -> str:
    written = sum(n for topic, n in writer.counts.items() if topic.endswith("/colour"))
    rate = f"{(recorder.received - 1) / seconds:.1f} Hz" if seconds > 0.0 else "- Hz"
    return (
        f"{written} frames, {seconds:.1f} s, {rate}, {writer.size / 1e6:.1f} MB, "
        f"{recorder.dropped} dropped"
    )
