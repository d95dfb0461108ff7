"""The messages of a bag of ROS 2 as they are stored: a folder with metadata, or a SQLite file."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from igrip.errors import RecordingError, requires_extra

METADATA = "metadata.yaml"


class RawMessage(NamedTuple):
    """One message of a bag, as CDR."""

    topic: str
    kind: str
    t: float  # when it was recorded [s]
    data: bytes


def is_bag(path: Path) -> bool:
    """Whether a folder is a bag of ROS 2."""
    return path.is_dir() and (path / METADATA).is_file()


def raw_messages(
    path: Path, kinds: Sequence[str], max_bytes: int, topics: Counter[tuple[str, str]]
) -> Iterator[RawMessage]:
    """Yield the messages of some types in order of time.

    Parameters
    ----------
    path : Path
        A folder with ``metadata.yaml``, or a file ``.db3``.
    kinds : sequence of str
        Types of the messages.
    max_bytes : int
        Longer messages are left out.
    topics : Counter
        Counts the messages of each topic and type of the bag, also of other types.

    Raises
    ------
    RecordingError
        If it is no bag, or is damaged.
    MissingExtraError
        If the package rosbags is not installed.
    """
    with requires_extra("rosbags", "ros2", "recordings of ROS 2"):
        import rosbags.rosbag2  # noqa: F401
    if not path.is_dir():
        yield from _database(path, kinds, max_bytes, topics)
    elif is_bag(path):
        yield from _folder(path, kinds, max_bytes, topics)
    else:
        raise RecordingError(f"{path}: is no bag of ROS 2: it has no {METADATA}")


def _folder(
    path: Path, kinds: Sequence[str], max_bytes: int, topics: Counter[tuple[str, str]]
) -> Iterator[RawMessage]:
    from rosbags.rosbag2 import Reader

    try:
        with Reader(path) as reader:
            for connection in reader.connections:
                topics[connection.topic, connection.msgtype] += connection.msgcount
            wanted = [c for c in reader.connections if c.msgtype in kinds]
            if not wanted:
                return
            for connection, time, data in reader.messages(wanted):
                if len(data) <= max_bytes:
                    topic, kind = connection.topic, connection.msgtype
                    yield RawMessage(topic, kind, time / 1e9, bytes(data))
    except GeneratorExit:
        raise
    except Exception as error:  # the package lets errors of its parts through
        raise RecordingError(f"{path}: {error!r:.300}") from error


def _database(
    path: Path, kinds: Sequence[str], max_bytes: int, topics: Counter[tuple[str, str]]
) -> Iterator[RawMessage]:
    query = (
        "SELECT topics.name, topics.type, timestamp, data FROM messages "
        "JOIN topics ON topics.id = messages.topic_id "
        f"WHERE topics.type IN ({','.join('?' * len(kinds))}) AND length(data) <= ? "
        "ORDER BY timestamp"
    )
    count = (
        "SELECT topics.name, topics.type, count(*) FROM messages "
        "JOIN topics ON topics.id = messages.topic_id GROUP BY topics.id"
    )
    try:
        uri = f"{path.resolve().as_uri()}?mode=ro"
        with closing(sqlite3.connect(uri, uri=True)) as connection:
            topics.update({(name, kind): n for name, kind, n in connection.execute(count)})
            for name, kind, time, data in connection.execute(query, (*kinds, max_bytes)):
                yield RawMessage(str(name), str(kind), time / 1e9, bytes(data))
    except (sqlite3.Error, TypeError, ValueError) as error:
        raise RecordingError(f"{path}: is no bag of ROS 2: {error}") from error
