"""Reading ``.mcap`` recordings, whether cut off or not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.io.defects import Defect
from igrip.io.frames import DeclaredFrame
from igrip.io.mcap import foxglove
from igrip.io.mcap.frames import FrameAssembler
from igrip.io.mcap.messages import OBSERVATIONS
from igrip.io.mcap.records import Record, Unpacker, packed_records
from igrip.io.recording_reader import RecordingReader, StoredMessage
from igrip.io.ros2.frames import FRAME_MESSAGES, RosFrames
from igrip.io.ros2.messages import READABLE, RosMessages, describe_topics, left_out
from igrip.io.ros2.storage import RawMessage
from igrip.rgbd import RgbdFrame


class McapReader(RecordingReader):
    """The observations of an ``.mcap`` file, in order; may be iterated again.

    A file that was cut off yields everything before the cut; :attr:`cut` then says where it was,
    and a warning is logged. It raises :class:`MissingExtraError` if ``mcap`` is not installed.
    """

    def __init__(self, path: str | Path, frame: DeclaredFrame | None = None) -> None:
        with requires_extra("mcap", "mcap", "MCAP recordings"):
            import mcap.records  # noqa: F401
        super().__init__(path, frame)

    def stored_messages(self) -> Iterator[StoredMessage]:
        """Yield the messages of the topic of observations, or the transforms and poses of ROS 2.

        Raises
        ------
        RecordingError
            If there are none; the message lists the topics that are there.
        """
        topics: Counter[tuple[str, str]] = Counter()
        ros: RosMessages | None = None
        for record in self.records(skip_damaged=True):
            topics[record.topic, record.schema] += 1
            place = f"message {record.number} of {record.topic}"
            if record.topic == OBSERVATIONS:
                yield StoredMessage(place, record.data)
            elif record.encoding == "cdr" and record.schema in READABLE:
                ros = ros or RosMessages()
                try:
                    content = ros.read(record.topic, record.schema, record.t, record.data)
                except ObservationError as error:
                    self.defects.add(Defect("skipped", "messages", str(error)), place)
                else:
                    yield StoredMessage(place, content)
        if topics and ros is None and not any(topic == OBSERVATIONS for topic, _ in topics):
            raise RecordingError(f"{self.path} {describe_topics(topics)}")
        if ros is not None:
            self.remarks += left_out(topics)

    def frames(self) -> Iterator[RgbdFrame]:
        """Yield the frames of all cameras as they were recorded, each camera's in order of time.

        Pictures of ROS 2 are read as :class:`igrip.io.ros2.frames.RosFrames` does.
        """
        assembler = FrameAssembler()
        ros: RosFrames | None = None
        for record in self.records():
            try:
                if record.encoding == "cdr" and record.schema in FRAME_MESSAGES:
                    ros = ros or RosFrames()
                    yield from ros.add(
                        RawMessage(record.topic, record.schema, record.t, record.data)
                    )
                    continue
                frame = assembler.add(record)
            except RecordingError as error:
                raise self._malformed(record, error) from error
            if frame is not None:
                yield frame
        if ros is not None:
            yield from ros.rest()
            self.remarks += ros.remarks()

    def pictures(self) -> Iterator[tuple[float, bytes]]:
        """Yield time [s] and colour picture, JPEG or PNG as stored, of every frame of igrip's own.

        Damage is skipped and named in :attr:`cut`.
        """
        for record in self.records(skip_damaged=True):
            if record.topic.endswith("/colour"):
                yield record.t, foxglove.packed_picture(record.data)

    def records(self, topics: tuple[str, ...] = (), skip_damaged: bool = False) -> Iterator[Record]:
        """Yield the messages of some topics, or of all, in the order of the file.

        Damage raises :class:`RecordingError`, or is skipped and named in :attr:`cut`.
        """
        unpacker = Unpacker(skip_damaged)
        with self.open() as file:
            for place, packed in packed_records(file):
                if packed is None:
                    self.note_cut(f"at byte {place}; {unpacker.counts.total()} messages read")
                    return
                problem = None
                try:
                    records = unpacker.unpack(packed)
                except RecordingError as error:
                    problem = str(error)
                except Exception as error:  # the package mcap trusts its input
                    problem = f"damaged: {error!r}"
                if problem is not None:
                    if not skip_damaged or not unpacker.counts:
                        raise RecordingError(f"{self.path}, byte {place}: {problem}")
                    self.note_cut(f"at byte {place}, which is left out: {problem}", "damaged")
                    continue
                if unpacker.gap is not None:
                    self.note_cut(f"before byte {place}: {unpacker.gap}", "damaged")
                    unpacker.gap = None
                yield from (r for r in records if not topics or r.topic in topics)

    def _malformed(self, record: Record, error: Exception) -> RecordingError:
        return RecordingError(f"{self.path}, message {record.number} of {record.topic}: {error}")
