"""What a user declares of a file: its frame, units, rate and words for missing numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from igrip.errors import DatasetError
from igrip.io.frames import DeclaredFrame, FrameError
from igrip.io.layouts import Layout


@dataclass(frozen=True)
class Declared:
    """What is declared; None: what the file states, else igrip's own.

    Attributes
    ----------
    up, axes, handedness, quaternions, length_unit, time_unit
        See :meth:`igrip.io.frames.DeclaredFrame.declare`.
    rate : float or None
        Frames per second, for a file without times [Hz].
    rotations : str or None
        What three numbers of a rotation are: ``rotvec``, or axes such as ``XYZ``.
    missing : sequence of str
        Further words and numbers for "not there".
    """

    up: str | None = None
    axes: tuple[str, ...] | str | None = None
    handedness: str | None = None
    quaternions: str | None = None
    length_unit: str | None = None
    time_unit: str | None = None
    rate: float | None = None
    rotations: str | None = None
    missing: tuple[str, ...] = ()

    def frame(self, layout: Layout | None = None) -> DeclaredFrame:
        """Return the frame of a file: what is declared, else what its layout states.

        Raises
        ------
        DatasetError
            If what is declared makes no frame.
        """
        up, length, time = self.up, self.length_unit, self.time_unit
        if layout is not None:
            length, time = length or layout.length_unit, time or layout.time_unit
            if self.up is None and self.axes is None:
                up = layout.up
        try:
            return DeclaredFrame.declare(
                up=up,
                axes=self.axes,
                handedness=self.handedness,
                quaternions=self.quaternions or "xyzw",
                length_unit=length or "m",
                time_unit=time or "s",
            )
        except FrameError as error:
            raise DatasetError(f"declared frame: {error}") from None

    def __or__(self, other: Declared) -> Declared:
        """Return these declarations, and where there is none, those of another."""
        mine: dict[str, Any] = {key: value for key, value in vars(self).items() if value}
        return Declared(**(vars(other) | mine))
