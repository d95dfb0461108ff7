"""Reading ``.mcap`` recordings, whether cut off or not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.io.files import RecordingReader, decode
from igrip.io.mcap.frames import FrameAssembler
from igrip.io.mcap.messages import OBSERVATIONS
from igrip.io.mcap.records import Record, Unpacker, packed_records
from igrip.observation import Observation
from igrip.rgbd import RgbdFrame


class McapReader(RecordingReader):
    """The observations of an ``.mcap`` file, in order; may be iterated again.

    A file that was cut off yields everything before the cut; :attr:`cut` then says where it was,
    and a warning is logged. It raises :class:`MissingExtraError` if ``mcap`` is not installed.
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
        """Yield the frames of all cameras as they were recorded, each camera's in order of time."""
        assembler = FrameAssembler()
        for record in self.records():
            try:
                frame = assembler.add(record)
            except RecordingError as error:
                raise self._malformed(record, error) from error
            if frame is not None:
                yield frame

    def records(self, topics: tuple[str, ...] = ()) -> Iterator[Record]:
        """Yield the messages of some topics, or of all, in the order of the file."""
        unpacker = Unpacker()
        with self.open() as file:
            for place, packed in packed_records(file):
                if packed is None:
                    self.note_cut(f"at byte {place}; {unpacker.counts.total()} messages read")
                    return
                try:
                    records = unpacker.unpack(packed)
                except RecordingError as error:
                    raise RecordingError(f"{self.path}, byte {place}: {error}") from error
                except Exception as error:  # the package mcap trusts its input
                    text = f"{self.path}, byte {place}: damaged: {error!r}"
                    raise RecordingError(text) from error
                yield from (r for r in records if not topics or r.topic in topics)

    def _malformed(self, record: Record, error: Exception) -> RecordingError:
        return RecordingError(f"{self.path}, message {record.number} of {record.topic}: {error}")
