"""Reading bags of ROS 2: folders with metadata, and single files of SQLite."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from igrip.errors import ObservationError, RecordingError, requires_extra
from igrip.io.defects import Defect
from igrip.io.frames import DeclaredFrame
from igrip.io.recording_reader import RecordingReader, StoredMessage
from igrip.io.ros2.messages import READABLE, RosMessages, describe_topics, left_out

METADATA = "metadata.yaml"
MAX_BYTES = 1 << 20  # of a message that is read; those of poses have less than one kB


class RawMessage(NamedTuple):
    """One message of a bag, as CDR."""

    topic: str
    kind: str
    t: float  # [s]
    data: bytes


def is_bag(path: Path) -> bool:
    """Whether a folder is a bag of ROS 2."""
    return path.is_dir() and (path / METADATA).is_file()


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
        for raw in self._folder(topics) if self.path.is_dir() else self._database(topics):
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

    def _folder(self, topics: Counter[tuple[str, str]]) -> Iterator[RawMessage]:
        from rosbags.rosbag2 import Reader

        try:
            with Reader(self.path) as reader:
                for connection in reader.connections:
                    topics[connection.topic, connection.msgtype] += connection.msgcount
                wanted = [c for c in reader.connections if c.msgtype in READABLE]
                if not wanted:
                    return
                for connection, time, data in reader.messages(wanted):
                    if len(data) <= MAX_BYTES:
                        topic, kind = connection.topic, connection.msgtype
                        yield RawMessage(topic, kind, time / 1e9, bytes(data))
        except GeneratorExit:
            raise
        except Exception as error:  # the package lets errors of its parts through
            raise RecordingError(f"{self.path}: {error!r:.300}") from error

    def _database(self, topics: Counter[tuple[str, str]]) -> Iterator[RawMessage]:
        query = (
            "SELECT topics.name, topics.type, timestamp, data FROM messages "
            "JOIN topics ON topics.id = messages.topic_id "
            f"WHERE topics.type IN ({','.join('?' * len(READABLE))}) AND length(data) <= ? "
            "ORDER BY timestamp"
        )
        count = (
            "SELECT topics.name, topics.type, count(*) FROM messages "
            "JOIN topics ON topics.id = messages.topic_id GROUP BY topics.id"
        )
        try:
            uri = f"{self.path.resolve().as_uri()}?mode=ro"
            with closing(sqlite3.connect(uri, uri=True)) as connection:
                topics.update({(name, kind): n for name, kind, n in connection.execute(count)})
                for name, kind, time, data in connection.execute(query, (*READABLE, MAX_BYTES)):
                    yield RawMessage(str(name), str(kind), time / 1e9, bytes(data))
        except (sqlite3.Error, TypeError, ValueError) as error:
            raise RecordingError(f"{self.path}: is no bag of ROS 2: {error}") from error
