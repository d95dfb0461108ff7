"""Reading bags of ROS 2: transforms and poses as observations, pictures as camera frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.io.defects import Defect
from igrip.io.frames import DeclaredFrame
from igrip.io.recording_reader import RecordingReader, StoredMessage
from igrip.io.ros2.frames import FRAME_MESSAGES, RosFrames
from igrip.io.ros2.messages import READABLE, RosMessages, describe_topics, left_out
from igrip.io.ros2.storage import METADATA, is_bag, raw_messages
from igrip.rgbd import RgbdFrame

MAX_BYTES = 1 << 20  # of a message that is read; those of poses have less than one kB
MAX_PICTURE_BYTES = 1 << 27


class BagReader(RecordingReader):
    """The transforms and poses of a bag as observations, in order; may be iterated again.

    Parameters
    ----------
    path : str or Path
        A folder with ``metadata.yaml``, or a file ``.db3``.
    frame : DeclaredFrame, optional
        Frame and units; those of ROS by default.
    """

    may_be_folder = True

    def __init__(self, path: str | Path, frame: DeclaredFrame | None = None) -> None:
        with requires_extra("rosbags", "ros2", "recordings of ROS 2"):
            import rosbags.rosbag2  # noqa: F401
        super().__init__(path, frame)
        if self.path.is_dir() and not is_bag(self.path):
            raise RecordingError(f"{self.path}: is no bag of ROS 2: it has no {METADATA}")

    def stored_messages(self) -> Iterator[StoredMessage]:
        """Yield the messages that hold transforms or poses.

        Raises
        ------
        RecordingError
            If there are none; the message lists what there is.
        """
        topics: Counter[tuple[str, str]] = Counter()
        numbers: Counter[str] = Counter()
        converter = RosMessages()
        for raw in raw_messages(self.path, READABLE, MAX_BYTES, topics):
            numbers[raw.topic] += 1
            place = f"message {numbers[raw.topic]} of {raw.topic}"
            try:
                content = converter.read(raw.topic, raw.kind, raw.t, raw.data)
            except ObservationError as error:
                self.defects.add(Defect("skipped", "messages", str(error)), place)
                continue
            yield StoredMessage(place, content)
        if not any(kind in READABLE for _, kind in topics):
            raise RecordingError(f"{self.path} {describe_topics(topics)}")
        self.remarks += left_out(topics)

    def frames(self) -> Iterator[RgbdFrame]:
        """Yield the frames of all cameras, each camera's in order of time.

        Times count from the first message.

        Raises
        ------
        RecordingError
            If there are none, or a message is damaged.
        """
        topics: Counter[tuple[str, str]] = Counter()
        assembler = RosFrames()
        for raw in raw_messages(self.path, FRAME_MESSAGES, MAX_PICTURE_BYTES, topics):
            try:
                yield from assembler.add(raw)
            except RecordingError as error:
                raise RecordingError(f"{self.path}, {raw.topic}: {error}") from error
        yield from assembler.rest()
        self.remarks += assembler.remarks()
        if not assembler.colour_topics:
            held = ", ".join(f"{topic} ({kind})" for topic, kind in list(topics)[:12])
            raise RecordingError(f"{self.path}: holds no colour pictures; it holds {held}")
