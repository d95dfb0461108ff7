"""The records of an ``.mcap`` file that may be cut off or damaged.

The package ``mcap`` parses records and chunks. Its readers allocate whatever a damaged length asks
for and do not report where a file was cut off, so records are delimited and bounded here.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from io import BytesIO
from typing import Any, BinaryIO, NamedTuple

from igrip.errors import RecordingError

MAGIC = b"\x89MCAP0\r\n"
HEAD = 9  # bytes of opcode and length before each record
MAX_BYTES = 1 << 26  # of a record, packed or not; the chunks that igrip writes have about one MB


class Record(NamedTuple):
    """One message of the file."""

    topic: str
    number: int  # within the topic, from 1
    t: float  # [s]
    data: bytes
    metadata: dict[str, str]  # of its channel
    schema: str = ""  # its name
    encoding: str = "json"


def packed_records(file: BinaryIO) -> Iterator[tuple[int, bytes | None]]:
    """Yield place and bytes of each record that leads to messages.

    The last one has None for its bytes if the file was cut off there, without an end mark.
    """
    from mcap.opcode import Opcode

    wanted = (Opcode.HEADER, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE, Opcode.CHUNK)
    size = os.fstat(file.fileno()).st_size
    magic = file.read(len(MAGIC))
    if magic != MAGIC[: len(magic)]:
        raise RecordingError(f"{file.name}: is no MCAP file")
    place = len(magic)
    while True:
        head = file.read(HEAD)
        length = int.from_bytes(head[1:], "little")
        # a file system may leave zeros after a crash
        if len(head) < HEAD or place + HEAD + length > size or not any(head):
            yield place, None
            return
        if head[0] == Opcode.DATA_END:
            return  # the index that follows is not needed
        if head[0] not in wanted:
            file.seek(length, os.SEEK_CUR)
        elif length > MAX_BYTES:
            text = f"a record of {length} bytes; at most {MAX_BYTES} are read"
            raise RecordingError(f"{file.name}, byte {place}: {text}")
        else:
            yield place, head + file.read(length)
        place += HEAD + length


class Unpacker:
    """Unpacks the records of one file, which follow each other, into messages.

    Attributes
    ----------
    counts : Counter
        How many messages were unpacked, by channel.
    gap : str or None
        Which messages are missing, where that is noted rather than raised.
    """

    def __init__(self, note_gaps: bool = False) -> None:
        self._note_gaps = note_gaps
        self.gap: str | None = None
        self._schemas: dict[int, str] = {}
        self.counts: Counter[int] = Counter()
        self._channels: dict[int, Any] = {}
        self._numbered = False  # igrip numbers the messages of each channel from 1

    def unpack(self, packed: bytes) -> list[Record]:
        """Return the messages in one record; whatever it raises, the record is damaged."""
        from mcap.records import Channel, Header, Message, Schema

        messages = []
        for item in _items(packed):
            if isinstance(item, Channel):
                self._channels[item.id] = item
            elif isinstance(item, Schema):
                self._schemas[item.id] = item.name
            elif isinstance(item, Header):
                self._numbered = item.library.startswith("igrip ")
            elif isinstance(item, Message):
                messages.append(self._message(item))
        return messages

    def _message(self, item: Any) -> Record:
        channel = self._channels.get(item.channel_id)
        if channel is None:
            raise RecordingError(f"a message of an unknown channel, {item.channel_id}")
        number = self.counts[channel.id] + 1
        if self._numbered and item.sequence != number:
            problem = f"of {channel.topic}, message {item.sequence} follows {number - 1}"
            if not self._note_gaps or item.sequence < number:
                raise RecordingError(f"damaged: {problem}")
            self.gap, number = problem, item.sequence
        self.counts[channel.id] = number
        return Record(
            channel.topic, number, item.log_time / 1e9, item.data, channel.metadata,
            self._schemas.get(channel.schema_id, ""), channel.message_encoding,
        )  # fmt: skip


def _items(packed: bytes) -> list[Any]:
    """Return the records inside a chunk; of any other record, the record itself."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk

    reader = StreamReader(BytesIO(packed), skip_magic=True, emit_chunks=True)
    record = next(iter(reader.records))
    if isinstance(record, Chunk):
        _bound(record)
        return list(breakup_chunk(record, validate_crc=True))
    return [record]


def _bound(chunk: Any) -> None:
    """Refuse a chunk that unpacks to more than it may."""
    size = max(chunk.uncompressed_size, len(chunk.data))
    if chunk.compression == "zstd":
        import zstandard

        size = max(size, zstandard.frame_content_size(chunk.data))
    elif chunk.compression == "lz4":
        import lz4.frame

        # the package mcap would unpack it all, however much that is
        unpacked = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        chunk.data, chunk.compression = unpacked, ""
    if size > MAX_BYTES:
        raise RecordingError(f"a chunk of {size} bytes; at most {MAX_BYTES} are read")
