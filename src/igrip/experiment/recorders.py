"""What records a trial: one file for each camera."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

from igrip.experiment.plan import PlannedTrial

ENDING = "mcap"


class TrialRecorder(Protocol):
    """Records trials, one after the other, with all cameras at once."""

    def seen(self) -> Mapping[str, bool]:
        """Return what a trial needs, hands and objects, and whether it is seen now."""

    def picture(self, camera: str) -> bytes | None:
        """Return what a camera sees now as JPEG; None: it has no picture."""

    def start(self, trial: PlannedTrial, attempt: int, files: Mapping[str, Path]) -> None:
        """Begin to record.

        Parameters
        ----------
        trial : PlannedTrial
            What the participant is to do.
        attempt : int
            Number of the attempt, from 1.
        files : mapping of str to Path
            The file of each camera.

        Raises
        ------
        IgripError
            If a camera cannot be used or a file cannot be written.
        """

    def mark(self, name: str, **data: Any) -> None:
        """Write an event into the files."""

    def failure(self) -> str | None:
        """Return what went wrong since the start; None: nothing."""

    def stop(self) -> None:
        """End the recording; when this returns, the files are on the disk.

        Raises
        ------
        IgripError
            If a camera was lost or the disk is full; then the attempt does not count.
        """

    def close(self) -> None:
        """Let go of the cameras."""
