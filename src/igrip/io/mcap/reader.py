"""Reading ``.mcap`` recordings, whether cut off or not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.io.files import RecordingFile, decode
from igrip.io.mcap.frames import FrameAssembler
from igrip.io.mcap.messages import OBSERVATIONS
from igrip.io.mcap.records import CutOffError, Record, read_records
from igrip.observation import Observation
from igrip.rgbd import RgbdFrame


class McapReader(RecordingFile):
    """The observations of an ``.mcap`` file, in order; may be iterated again.

    A file that was cut off (a full disk, a killed recorder) yields everything before the cut;
    :attr:`cut` then says where it was, and a warning is logged.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    RecordingError
        If the file cannot be opened; while iterating, if it is damaged, or a message is malformed
        (file, message and field are named).
    MissingExtraError
        If the package ``mcap`` is not installed.
    """

    def __init__(self, path: str | Path) -> None:
        with requires_extra("mcap", "mcap", "MCAP recordings"):
            import mcap.records  # noqa: F401
        super().__init__(path)

    def __iter__(self) -> Iterator[Observation]:
        last = -1.0
        for record in self.records((OBSERVATIONS,)):
            try:
                observation = decode(record.data, not_before=last)
            except ObservationError as error:
                raise self._malformed(record, error) from error
            last = observation.t
            yield observation

    def frames(self) -> Iterator[RgbdFrame]:
        """Yield the frames of all cameras as they were recorded, each camera's in order of time.

        Raises
        ------
        RecordingError
            If the file is damaged or a frame malformed.
        """
        assembler = FrameAssembler()
        for record in self.records():
            try:
                frame = assembler.add(record)
            except RecordingError as error:
                raise self._malformed(record, error) from error
            if frame is not None:
                yield frame

    def records(self, topics: tuple[str, ...] = ()) -> Iterator[Record]:
        """Yield the messages of some topics, or of all, in the order of the file.

        Raises
        ------
        RecordingError
            If the file is damaged.
        """
        count = 0
        with self.open() as file:
            try:
                for record in read_records(file):
                    count += 1
                    if not topics or record.topic in topics:
                        yield record
            except CutOffError as cut:
                self.note_cut(f"at byte {cut.place}; {count} messages read")
            except RecordingError as error:
                raise RecordingError(f"{self.path}, {error}") from error

    def _malformed(self, record: Record, error: Exception) -> RecordingError:
        return RecordingError(f"{self.path}, message {record.number} of {record.topic}: {error}")
