"""``igrip record``: what cameras see, into a file that Foxglove and igrip read."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import Annotated

import typer

from igrip.cli.console import errors, output
from igrip.errors import RecordingError
from igrip.io.recordings.mcap_writer import McapWriter
from igrip.io.recordings.recorder import Recorder
from igrip.perception.cameras import Camera, CameraError, open_camera

SAY_EVERY = 0.25  # s


def record(
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to write (.mcap).")],
    camera: Annotated[
        str,
        typer.Option(help="oak, realsense, webcam:0, replay:FILE; several joined by +."),
    ] = "oak",
    seconds: Annotated[
        float | None, typer.Option(help="For how long. Default: until Ctrl-C.", min=0.0)
    ] = None,
    calibration: Annotated[
        Path | None, typer.Option(help="Where the cameras stand: a file of igrip calibrate.")
    ] = None,
    lossless: Annotated[
        bool, typer.Option("--lossless", help="Colour as PNG; slower, and several times larger.")
    ] = False,
) -> None:
    """Record colour, depth and intrinsics of cameras.

    Frames that cannot be written in time are dropped and counted. A kill or a pulled cable costs at
    most the last half second. Exit code 1: a camera failed; what came before it is in the file.

    Example: igrip record --camera oak --out table.mcap --seconds 30
    """
    if out.suffix.lower() != ".mcap":
        raise RecordingError(f"{out}: frames are recorded as .mcap")
    device = open_camera(camera, calibration)
    try:
        if note := getattr(device, "note", None):
            errors.print(note, style="yellow", soft_wrap=True)
        with McapWriter(out, lossless=lossless) as writer:
            failed = _record(device, writer, seconds)
    finally:
        device.close()
    if failed is not None:
        errors.print(f"igrip: {failed}", style="red", soft_wrap=True)
        raise typer.Exit(1)


def _record(camera: Camera, writer: McapWriter, seconds: float | None) -> CameraError | None:
    """Record until it is over; return what a camera failed of."""
    recorder, failed = Recorder(writer), None
    first = last = 0.0
    said = time.monotonic()
    with errors.status("waiting for the first frame …") as status:
        try:
            for frame in camera:
                first = frame.t if not recorder.taken else first
                if seconds is not None and frame.t - first > seconds:
                    break
                last = max(last, frame.t)
                recorder.take(frame)
                if time.monotonic() - said >= SAY_EVERY:
                    said = time.monotonic()
                    status.update(f"{_words(recorder, writer, last - first)}; Ctrl-C ends")
        except KeyboardInterrupt:
            pass
        except CameraError as error:
            failed = error
            with contextlib.suppress(RecordingError):
                writer.write_event(last, "camera failed", message=str(error))
        finally:
            camera.close()
            try:
                recorder.close()
            finally:  # what is in the file is said even if the disk is full
                words = _words(recorder, writer, last - first)
                output.print(f"{writer.path}: {words}", soft_wrap=True)
    return failed


def _words(recorder: Recorder, writer: McapWriter, seconds: float) -> str:
    written = sum(n for topic, n in writer.counts.items() if topic.endswith("/colour"))
    rate = f"{(recorder.taken - 1) / seconds:.1f} Hz" if seconds > 0.0 else "- Hz"
    return (
        f"{written} frames, {seconds:.1f} s, {rate}, {writer.size / 1e6:.1f} MB, "
        f"{recorder.dropped} dropped"
    )
